#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "pictures/flight_figure.h"

namespace nuno {

struct FilmOptions {
  std::string name;  ///< its file's, for people; ends in .gif, .mp4 or .webm
  double speed = 1;  ///< over that of the flight, > 0
  /// Is told how much of the film is made, 0 … 1; what it throws ends the work.
  std::function<void(double share)> progress = {};
};

/// Throws ExternalError where the program that makes films is missing.
void require_film_maker(const std::string& name);

/// Makes a film of flights over one another, with a rest at arrival. `out` is a file and no pipe: a
/// film is finished at its beginning. Throws InputError for one that is too long, ExternalError.
void write_film(const std::vector<figures::Flight>& flights, const figures::FlightFigure& figure,
                const FilmOptions& options, std::FILE* out);

}  // namespace nuno
