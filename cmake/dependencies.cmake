# Each dependency is the system's or, where the system has none, fetched in the version that Debian
# 12 has, on which everything here is tested.
include(FetchContent)

# Sets ${name}_FOUND, or fetches: `directory` is the part with the CMakeLists.txt to add, "headers"
# for a library that has only headers.
set(NUNO_FETCHED "")
macro(nuno_find_or_fetch name version repository tag directory)
  find_package(${name} ${version} QUIET CONFIG)
  if(NOT ${name}_FOUND)
    message(STATUS "No ${name} ${version} here: fetching ${repository} ${tag}")
    list(APPEND NUNO_FETCHED ${name})
    FetchContent_Declare(
      ${name}
      GIT_REPOSITORY ${repository}
      GIT_TAG ${tag}
      GIT_SHALLOW TRUE
      SOURCE_SUBDIR ${directory})
    FetchContent_MakeAvailable(${name})
  endif()
endmacro()

# A target for the fetched headers of `name` in `directory`; imported, so free of our warnings.
function(nuno_header_target target name directory)
  string(TOLOWER ${name} name)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} INTERFACE "${${name}_SOURCE_DIR}/${directory}")
endfunction()

# The name that an installed package gives to a fetched library, free of our warnings as well.
function(nuno_name_target name target)
  get_target_property(directories ${target} INTERFACE_INCLUDE_DIRECTORIES)
  set_target_properties(${target} PROPERTIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${directories}")
  if(NOT TARGET ${name})
    add_library(${name} ALIAS ${target})
  endif()
endfunction()

find_package(Threads REQUIRED)

nuno_find_or_fetch(Eigen3 3.4 https://gitlab.com/libeigen/eigen.git 3.4.0 headers)
if("Eigen3" IN_LIST NUNO_FETCHED)
  nuno_header_target(Eigen3::Eigen Eigen3 .)
endif()

nuno_find_or_fetch(nlohmann_json 3.11 https://github.com/nlohmann/json.git v3.11.2 headers)
if("nlohmann_json" IN_LIST NUNO_FETCHED)
  nuno_header_target(nlohmann_json::nlohmann_json nlohmann_json include)
endif()

# Boost.Math alone; it does without the rest of Boost.
nuno_find_or_fetch(Boost 1.74 https://github.com/boostorg/math.git boost-1.83.0 headers)
if("Boost" IN_LIST NUNO_FETCHED)
  nuno_header_target(Boost::headers Boost include)
  target_compile_definitions(Boost::headers INTERFACE BOOST_MATH_STANDALONE)
endif()

nuno_find_or_fetch(fmt 9 https://github.com/fmtlib/fmt.git 9.1.0 .)
if("fmt" IN_LIST NUNO_FETCHED)
  nuno_name_target(fmt::fmt fmt)
endif()

# The variables below are options of the projects fetched.
set(CMAKE_POLICY_DEFAULT_CMP0077 NEW)
set(CMAKE_POLICY_DEFAULT_CMP0126 NEW)
set(BUILD_TESTING OFF)
set(HWY_ENABLE_CONTRIB OFF)
set(HWY_ENABLE_EXAMPLES OFF)
set(HWY_ENABLE_INSTALL OFF)
set(HWY_ENABLE_TESTS OFF)
nuno_find_or_fetch(hwy 1.0.3 https://github.com/google/highway.git 1.0.3 .)
if("hwy" IN_LIST NUNO_FETCHED)
  nuno_name_target(hwy::hwy hwy)
endif()

set(BOX2D_BUILD_TESTBED OFF)
set(BOX2D_BUILD_UNIT_TESTS OFF)
nuno_find_or_fetch(box2d 2.4.1 https://github.com/erincatto/box2d.git v2.4.1 .)
if("box2d" IN_LIST NUNO_FETCHED)
  nuno_name_target(box2d::box2d box2d)
endif()

if(NUNO_BUILD_DEMOS)
  nuno_find_or_fetch(CLI11 2.1 https://github.com/CLIUtils/CLI11.git v2.1.2 headers)
  if("CLI11" IN_LIST NUNO_FETCHED)
    nuno_header_target(CLI11::CLI11 CLI11 include)
  endif()

  # Debian's is a shared library whose defines, which only pkg-config knows, are part of its ABI.
  find_package(PkgConfig QUIET)
  if(PkgConfig_FOUND)
    pkg_check_modules(cpp-httplib QUIET IMPORTED_TARGET cpp-httplib)
  endif()
  add_library(nuno_httplib INTERFACE)
  add_library(nuno::httplib ALIAS nuno_httplib)
  if(TARGET PkgConfig::cpp-httplib)
    target_link_libraries(nuno_httplib INTERFACE PkgConfig::cpp-httplib)
  else()
    nuno_find_or_fetch(httplib 0.11 https://github.com/yhirose/cpp-httplib.git v0.11.4 .)
    target_link_libraries(nuno_httplib INTERFACE httplib::httplib)
  endif()
endif()

if(NUNO_BUILD_TESTS)
  set(BUILD_GMOCK OFF)
  set(INSTALL_GTEST OFF)
  nuno_find_or_fetch(GTest 1.12 https://github.com/google/googletest.git release-1.12.1 .)
endif()
