#pragma once

#include <nuno/backend.h>

namespace nuno::native {

/// The sheet's engine, for a problem that has a sheet.
std::unique_ptr<Backend> make_sheet_backend(const Problem& problem);

}  // namespace nuno::native
