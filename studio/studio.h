#pragma once

namespace nuno {

/// The page on which both shapes are drawn.
struct StudioOptions {
  int port = 8471;            ///< of 127.0.0.1, 0 … 65535; 0, or one that is taken: any free one
  bool opens_browser = true;  ///< where there is a desktop
};

/// Serves the page until the program is ended. Throws OutputError where no port is free.
void serve_studio(const StudioOptions& options);

}  // namespace nuno
