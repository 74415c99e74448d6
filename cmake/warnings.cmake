# nuno_warnings: linked privately by every target of the project, never installed.
add_library(nuno_warnings INTERFACE)
target_compile_options(
  nuno_warnings
  INTERFACE
    -Wall
    -Wextra
    -Wpedantic
    -Wshadow
    -Wconversion
    -Wnon-virtual-dtor
    -Wold-style-cast
    -Woverloaded-virtual
    $<$<BOOL:${NUNO_WARNINGS_AS_ERRORS}>:-Werror>)
