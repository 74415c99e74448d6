# cmake -DROOT=… -P arrows_test.cmake: every room includes only what lies below it, and a library
# from outside stands only in the rooms that are made for it.
cmake_minimum_required(VERSION 3.22)

# From the ground up; the rooms of one floor know nothing of each other.
set(floors
    "core"
    "native_backend box2d_backend bullet_backend"
    "formats"
    "engines"
    "pictures"
    "studio"
    "demos bench python")
# Headers from outside, as a regular expression, and the only rooms that may have them.
set(guests
    "nlohmann/.*|formats pictures studio demos bench"
    "CLI/.*|demos"
    "httplib.h|studio"
    "box2d/.*|box2d_backend bench"
    "(Bullet|bt|Linear).*|bullet_backend bench"
    "pybind11/.*|python"
    "hwy/.*|native_backend bench")

set(number 0)
foreach(floor IN LISTS floors)
  string(REPLACE " " ";" rooms "${floor}")
  foreach(room IN LISTS rooms)
    set(floor_of_${room} ${number})
    file(GLOB headers RELATIVE "${ROOT}/${room}/include" "${ROOT}/${room}/include/nuno/*.h")
    foreach(header IN LISTS headers)
      set("room_of_${header}" ${room})
    endforeach()
  endforeach()
  math(EXPR number "${number} + 1")
endforeach()

set(wrong "")
set(seen 0)
foreach(floor IN LISTS floors)
  string(REPLACE " " ";" rooms "${floor}")
  foreach(room IN LISTS rooms)
    file(GLOB_RECURSE sources "${ROOT}/${room}/*.h" "${ROOT}/${room}/*.cpp")
    foreach(source IN LISTS sources)
      file(STRINGS "${source}" includes REGEX "^#include [<\"]")
      file(RELATIVE_PATH place "${ROOT}" "${source}")
      foreach(line IN LISTS includes)
        if(NOT line MATCHES "[<\"]([^>\"]*)[>\"]")
          continue()
        endif()
        set(header "${CMAKE_MATCH_1}")
        math(EXPR seen "${seen} + 1")
        string(REGEX REPLACE "/.*" "" folder "${header}")
        set(target "")
        if(DEFINED "room_of_${header}")
          set(target "${room_of_${header}}")
        elseif(DEFINED "floor_of_${folder}")
          set(target "${folder}")
        elseif(header MATCHES "^nuno/|[.][.]/")
          string(APPEND wrong "${place}: <${header}> is in no room\n")
        endif()
        if(target AND NOT target STREQUAL room AND NOT floor_of_${target} LESS floor_of_${room})
          string(APPEND wrong "${place}: ${header} is ${target}'s, which is not below ${room}\n")
        endif()
        foreach(guest IN LISTS guests)
          string(REGEX MATCH "^(.*)[|]([^|]*)$" guest "${guest}")
          set(allowed " ${CMAKE_MATCH_2} ")
          if(header MATCHES "^${CMAKE_MATCH_1}$" AND NOT allowed MATCHES " ${room} "
             AND NOT target)
            string(APPEND wrong "${place}: ${header} has no place in ${room}\n")
          endif()
        endforeach()
      endforeach()
    endforeach()
  endforeach()
endforeach()

if(wrong)
  message(FATAL_ERROR "Arrows must point down:\n${wrong}")
endif()
if(seen LESS 500)
  message(FATAL_ERROR "only ${seen} #include lines were found: the test looks in the wrong place")
endif()
message(STATUS "${seen} #include lines point down")
