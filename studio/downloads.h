#pragma once

#include "studio/answers.h"
#include "studio/request.h"

namespace nuno::studio {

// The files that the page saves. They throw InputError, OutputError and Stopped.

/// What --out writes: simulate's result where a gain is given, else optimize's.
Answer result_answer(const Request& request);

/// The flight as a mesh in motion, what `nuno throw` writes.
Answer animation_answer(const Request& request);

/// Both engines on the scene, as the page that `nuno compare` writes.
Answer report_answer(const Request& request);

/// What `nuno render` makes of the result.
Answer film_answer(const Request& request);

}  // namespace nuno::studio
