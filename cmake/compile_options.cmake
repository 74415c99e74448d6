# For every target of the project, by directory, since half a sanitized program is none.

# Products and sums round one by one: equal inputs give equal bits in scalar, SIMD and batch code,
# whatever the compiler. Where the kernel wants a fused multiply-add, it writes one.
add_compile_options(-ffp-contract=off)

# Out-of-range indices and broken preconditions of the standard library stop a debug build.
add_compile_definitions($<$<CONFIG:Debug>:_GLIBCXX_ASSERTIONS>)

if(NUNO_SANITIZE)
  # A finding ends the program, or a test would pass over it; whole stacks in its report.
  add_compile_options(-fsanitize=${NUNO_SANITIZE} -fno-sanitize-recover=all
                      -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${NUNO_SANITIZE})
endif()

# nuno_warnings: linked by every target of the project, never installed. Never errors in a sanitized
# build: GCC's checks hide values from its own analysis, which then warns of what cannot happen.
add_library(nuno_warnings INTERFACE)
target_compile_options(
  nuno_warnings
  INTERFACE
    -Wall
    -Wextra
    -Wpedantic
    -Wshadow
    -Wconversion # a double that loses digits on its way into Box2D says so
    -Wnon-virtual-dtor
    -Wold-style-cast
    -Woverloaded-virtual)
if(NUNO_WARNINGS_AS_ERRORS AND NOT NUNO_SANITIZE)
  target_compile_options(nuno_warnings INTERFACE -Werror)
endif()
