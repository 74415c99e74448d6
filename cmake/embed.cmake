# nuno_embed(TARGET FILE…): puts text files into a program. Of page.html,
#     #include "embedded/page_html.h"
# declares std::string_view nuno::embedded::page_html. Made again when the file changes.
#
# This file is the function when it is included, and the step of the build when it is run
# (cmake -DINPUT=… -DOUTPUT=… -DNAME=… -P embed.cmake).
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(NUNO_EMBED_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")

  function(nuno_embed target)
    set(folder "${CMAKE_CURRENT_BINARY_DIR}/nuno_embed")
    foreach(file IN LISTS ARGN)
      get_filename_component(input "${file}" ABSOLUTE)
      get_filename_component(name "${file}" NAME)
      string(MAKE_C_IDENTIFIER "${name}" name)
      string(TOLOWER "${name}" name)
      set(output "${folder}/embedded/${name}.cpp")
      file(
        CONFIGURE
        OUTPUT "${folder}/embedded/${name}.h"
        CONTENT
          "#pragma once

#include <string_view>

namespace nuno::embedded {

extern const std::string_view ${name};

}  // namespace nuno::embedded
")
      add_custom_command(
        OUTPUT "${output}"
        COMMAND "${CMAKE_COMMAND}" "-DINPUT=${input}" "-DOUTPUT=${output}" "-DNAME=${name}" -P
                "${NUNO_EMBED_SCRIPT}"
        DEPENDS "${input}" "${NUNO_EMBED_SCRIPT}"
        COMMENT "Embedding ${file}"
        VERBATIM)
      target_sources(${target} PRIVATE "${output}")
    endforeach()
    target_include_directories(${target} PRIVATE "${folder}")
  endfunction()
  return()
endif()

file(READ "${INPUT}" bytes HEX)
string(LENGTH "${bytes}" size)
math(EXPR size "${size} / 2")
set(pair "[0-9a-f][0-9a-f]")
string(REPEAT "${pair}" 24 line)
string(REGEX REPLACE "(${line})" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "(${pair})" "\\\\x\\1" bytes "${bytes}")
string(REPLACE "\n" "\"\n\"" bytes "${bytes}")
file(
  WRITE "${OUTPUT}"
  "#include \"${NAME}.h\"

namespace nuno::embedded {

constinit const std::string_view ${NAME}(
\"${bytes}\",
${size});

}  // namespace nuno::embedded
")
