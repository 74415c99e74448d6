#pragma once

#include <nuno/backend.h>

#include <vector>

namespace nuno {

/// Velocities that bring each particle from `from` to `to` [d × N] in `arrival_time` under gravity
/// and linear drag, κ = k/m [1/s]: equations (1) and (2) of the paper, with z = κ·t₀ and
/// φ = (1 − e⁻ᶻ)/z,
///     v_x = Δx/(t₀·φ),   v_y = Δy/(t₀·φ) + g·t₀·(1 − φ)/(z·φ),
/// and in space v_z like v_x.
/// The paper prints g₀ for the last term of (2), where its derivation gives g·t₀: integrating
/// m·v̇ = −m·g − k·v twice,
///     y(t₀) − y₀ = (m/k)·(v₀ + m·g/k)·(1 − e⁻ᶻ) − (m·g/k)·t₀.
/// Finite and exact for every κ ≥ 0; κ = 0 is the parabola.
Points ballistic_launch(const Points& from, const Points& to, double arrival_time, double gravity,
                        double drag_rate);

/// The same, solved for an engine's own recurrence over `steps` steps.
Points ballistic_launch(const Points& from, const Points& to, double gravity,
                        const DragRecurrence& recurrence, Index steps);

/// The velocities nearest to the given ones (least squares; equal masses) that leave the length of
/// every segment of the chain `positions` unchanged. Keeps the total momentum.
Points without_stretching(const Points& positions, const Points& velocities);

/// The same for any cloth in these positions [d × N]: those nearest by mass-weighted least squares
/// that leave the length of every edge unchanged, or as nearly as the edges allow.
Points without_stretching(const Cloth& cloth, const Points& positions, const Points& velocities);

/// The same from the problem's initial positions.
Points without_stretching(const Problem& problem, const Points& velocities);

/// The launch that the backend's problem asks for, arriving on the backend's own recurrence: each
/// particle on its own ballistic path, or, where the reference moves, the shape along the reference
/// and the centroid on its ballistic path; a reference correction changes either as it begins to
/// move the reference, and `inextensible` removes what stretches.
Points launch(const Backend& backend);

/// What a quantity gains by the reference corrections of a problem, from what it gains by their
/// offsets about the mass centre, `by_offsets` [d × N each], per m, and by the launch, `by_launch`
/// [d × N], per m/s: the transpose of what ReferenceMotion and `launch` make of a correction.
std::vector<Points> correction_cotangents(const Problem& problem, std::vector<Points> by_offsets,
                                          const Points& by_launch);

}  // namespace nuno
