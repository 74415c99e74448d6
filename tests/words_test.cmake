# cmake -DROOT=… -P words_test.cmake: what people read (headers, help, page, docs) uses the field's
# standard terms, not those that this house once had of its own. docs/glossary.md has the words.
cmake_minimum_required(VERSION 3.22)

# The old word as a regular expression | the standard term.
set(words
    "miss(es|ed)?|residual, error"
    "tangents?|Jacobian, directional derivative"
    "promise[sd]?|predicted reduction, predict"
    "neighbou?rhoods?|trust region, local model"
    "aim(s|ed|ing)?[ -]off|trajectory refinement"
    "aim(ing)?[ -]offsets?|reference correction"
    "carr(y|ies|ied|ying)[ -]over|transfer"
    "following[ -]gains?|tracking gain"
    "trad(e|es|ed|ing)[ -]?offs?|Pareto front"
    "disturb(ance|ances|ed|s)?|perturbation"
    "slopes?|derivative")

file(
  GLOB_RECURSE places RELATIVE "${ROOT}"
  "${ROOT}/*/*.h" "${ROOT}/demos/*.cpp" "${ROOT}/studio/page/*" "${ROOT}/studio/*.md"
  "${ROOT}/pictures/*.js" "${ROOT}/docs/*.md" "${ROOT}/docs/*.svg" "${ROOT}/demos/*.py")
file(GLOB tops RELATIVE "${ROOT}" "${ROOT}/*.md" "${ROOT}/run")
list(FILTER places EXCLUDE REGEX "^(build|out)[^/]*/|docs/glossary[.]md")

set(wrong "")
set(lines_read 0)
foreach(place IN LISTS places tops)
  file(READ "${ROOT}/${place}" text)
  string(REGEX REPLACE "[][;\\]" " " text "${text}") # what lists of CMake trip over
  string(REGEX REPLACE "(new Promise|Promise[.])" "" text "${text}") # JavaScript's own
  string(TOLOWER "${text}" text)
  string(REPLACE "\n" ";" lines "${text}")
  set(number 0)
  foreach(line IN LISTS lines)
    math(EXPR number "${number} + 1")
    math(EXPR lines_read "${lines_read} + 1")
    foreach(word IN LISTS words)
      string(REGEX MATCH "^(.*)[|]([^|]*)$" word "${word}")
      set(better "${CMAKE_MATCH_2}")
      if(" ${line} " MATCHES "[^a-z_](${CMAKE_MATCH_1})[^a-z_]")
        string(APPEND wrong "${place}:${number}: ${CMAKE_MATCH_1}; say ${better}\n")
      endif()
    endforeach()
  endforeach()
endforeach()

if(wrong)
  message(FATAL_ERROR "Words of the old language:\n${wrong}")
endif()
if(lines_read LESS 8000)
  message(FATAL_ERROR "only ${lines_read} lines were read: the test looks in the wrong place")
endif()
message(STATUS "${lines_read} lines speak the field's language")
