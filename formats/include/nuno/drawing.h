#pragma once

#include <nuno/points.h>
#include <nuno/scene.h>

#include <string>

namespace nuno {

// Drawn lines, of which a chain is a cloth. A curve is named FILE, where it is the only one of its
// file, or FILE#NAME: FILE ends in .svg, .obj or .csv. Every reader throws InputError with file,
// line, value and rule; curves that are not asked for may be what they like.

/// Whether a file holds drawn lines: .svg, .csv, or an .obj that has lines (l) and no faces (f).
bool is_drawing(const std::string& curve);

/// Reads a curve as a polyline [2 × n], m, y up.
Points read_curve(const std::string& curve);

/// The curve called `name` of an SVG text, or the only one for "". A name is an element's id or
/// Inkscape's label of it, or that of a group with a single curve in it.
/// All commands of paths, all transforms, nested viewports, `use` and all basic shapes are read;
/// curves become polylines no farther off than 1e-6 of their length. What is not displayed is not
/// drawn. Lengths are those of the page, 1 mm is 0.001 m and a px 1/96 inch; its lower left corner
/// is the origin. `source` names the text in messages.
Points parse_svg(const std::string& text, const std::string& source, const std::string& name);

/// The same of Wavefront OBJ: its lines (l), of the object or group (o, g) called `name`. Segments
/// that meet are one curve, in whatever order they stand. It is to lie in a plane of x and y.
Points parse_obj_curve(const std::string& text, const std::string& source, const std::string& name);

/// A point x,y on each line; the separator may also be a semicolon or a blank. Titles above the
/// points and what stands after # are passed over.
Points parse_csv(const std::string& text, const std::string& source);

/// Gives a chain's scene its shapes from two curves, and validates it; `source` names the scene in
/// messages.
ChainScene with_drawings(ChainScene scene, const std::string& initial, const std::string& target,
                         const std::string& source);

}  // namespace nuno
