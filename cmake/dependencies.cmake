# Each dependency is the system's or, where the system has none, fetched in the version that Debian
# 12 has, on which everything here is tested.
include(FetchContent)

# The system's package `name`, or else what `repository` has at `tag`, under the name `target` that
# the package gives to its library, and free of our warnings as a package is. HEADERS names the
# folder of a library that has only headers: nothing of it is configured or built.
set(NUNO_FETCHED "")
set(NUNO_BUILT_WITH "") # names and versions, for --version
function(nuno_find_or_fetch name version target repository tag)
  cmake_parse_arguments(PARSE_ARGV 5 only "" "HEADERS" "")
  find_package(${name} ${version} QUIET CONFIG)
  if(${name}_FOUND)
    set(NUNO_BUILT_WITH ${NUNO_BUILT_WITH} "${name} ${${name}_VERSION}" PARENT_SCOPE)
    return()
  endif()
  message(STATUS "No ${name} ${version} here: fetching ${repository} ${tag}")
  set(NUNO_FETCHED ${NUNO_FETCHED} ${name} PARENT_SCOPE)
  set(NUNO_BUILT_WITH ${NUNO_BUILT_WITH} "${name} ${tag}" PARENT_SCOPE)
  set(project_folder .)
  if(only_HEADERS)
    set(project_folder none) # without a CMakeLists.txt
  endif()
  FetchContent_Declare(
    ${name}
    GIT_REPOSITORY ${repository}
    GIT_TAG ${tag}
    GIT_SHALLOW TRUE
    SOURCE_SUBDIR ${project_folder})
  FetchContent_MakeAvailable(${name})

  if(only_HEADERS)
    string(TOLOWER ${name} fetched)
    add_library(${target} INTERFACE IMPORTED GLOBAL)
    target_include_directories(${target} INTERFACE "${${fetched}_SOURCE_DIR}/${only_HEADERS}")
    return()
  endif()
  if(TARGET ${target})
    get_target_property(library ${target} ALIASED_TARGET)
  else()
    string(REGEX REPLACE ".*::" "" library ${target})
  endif()
  get_target_property(directories ${library} INTERFACE_INCLUDE_DIRECTORIES)
  if(directories)
    set_target_properties(
      ${library} PROPERTIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${directories}")
  endif()
  if(NOT TARGET ${target})
    add_library(${target} ALIAS ${library})
  endif()
endfunction()

find_package(Threads REQUIRED)

nuno_find_or_fetch(
  Eigen3 3.4 Eigen3::Eigen https://gitlab.com/libeigen/eigen.git 3.4.0 HEADERS .)
nuno_find_or_fetch(
  nlohmann_json 3.11 nlohmann_json::nlohmann_json https://github.com/nlohmann/json.git v3.11.2
  HEADERS include)
# The library needs Boost.Math alone, which does without the rest of Boost; the studio, Asio and
# Beast, which do not.
find_package(Boost 1.74 QUIET CONFIG)
if(NOT Boost_FOUND AND NUNO_BUILD_DEMOS)
  message(STATUS "No Boost 1.74 here: fetching 1.83.0")
  list(APPEND NUNO_FETCHED Boost)
  set(BOOST_INCLUDE_LIBRARIES asio beast math)
  FetchContent_Declare(
    Boost
    URL https://github.com/boostorg/boost/releases/download/boost-1.83.0/boost-1.83.0.tar.xz)
  FetchContent_MakeAvailable(Boost)
  if(NOT TARGET Boost::headers)
    add_library(nuno_boost INTERFACE)
    target_link_libraries(nuno_boost INTERFACE Boost::asio Boost::beast Boost::math)
    add_library(Boost::headers ALIAS nuno_boost)
  endif()
else()
  nuno_find_or_fetch(
    Boost 1.74 Boost::headers https://github.com/boostorg/math.git boost-1.83.0 HEADERS include)
  if("Boost" IN_LIST NUNO_FETCHED)
    target_compile_definitions(Boost::headers INTERFACE BOOST_MATH_STANDALONE)
  endif()
endif()
nuno_find_or_fetch(fmt 9 fmt::fmt https://github.com/fmtlib/fmt.git 9.1.0)
nuno_find_or_fetch(
  pugixml 1.12 pugixml::pugixml https://github.com/zeux/pugixml.git v1.13)

# The variables below are options of the projects fetched.
set(CMAKE_POLICY_DEFAULT_CMP0077 NEW)
set(CMAKE_POLICY_DEFAULT_CMP0126 NEW)
set(BUILD_TESTING OFF)
set(HWY_ENABLE_CONTRIB OFF)
set(HWY_ENABLE_EXAMPLES OFF)
set(HWY_ENABLE_INSTALL OFF)
set(HWY_ENABLE_TESTS OFF)
nuno_find_or_fetch(hwy 1.0.3 hwy::hwy https://github.com/google/highway.git 1.0.3)

set(BOX2D_BUILD_TESTBED OFF)
set(BOX2D_BUILD_UNIT_TESTS OFF)
nuno_find_or_fetch(box2d 2.4.1 box2d::box2d https://github.com/erincatto/box2d.git v2.4.1)

# Debian's own CMake package of Bullet names no targets and no folders that can be used; its
# pkg-config also tells the precision that it was built with.
find_package(PkgConfig QUIET)
if(PkgConfig_FOUND)
  pkg_check_modules(bullet QUIET IMPORTED_TARGET bullet)
  if(bullet_FOUND)
    list(APPEND NUNO_BUILT_WITH "bullet ${bullet_VERSION}")
  endif()
endif()
if(NOT TARGET PkgConfig::bullet)
  set(BUILD_BULLET2_DEMOS OFF)
  set(BUILD_BULLET3 OFF)
  set(BUILD_CPU_DEMOS OFF)
  set(BUILD_ENET OFF)
  set(BUILD_CLSOCKET OFF)
  set(BUILD_EXTRAS OFF)
  set(BUILD_OPENGL3_DEMOS OFF)
  set(BUILD_UNIT_TESTS OFF)
  set(USE_GRAPHICAL_BENCHMARK OFF)
  nuno_find_or_fetch(
    bullet 3.24 BulletSoftBody https://github.com/bulletphysics/bullet3.git 3.24)
  add_library(nuno_bullet_engine INTERFACE)
  add_library(PkgConfig::bullet ALIAS nuno_bullet_engine)
  target_include_directories(nuno_bullet_engine SYSTEM INTERFACE "${bullet_SOURCE_DIR}/src")
  target_link_libraries(nuno_bullet_engine INTERFACE BulletSoftBody BulletDynamics BulletCollision
                                                     LinearMath)
endif()

if(NUNO_BUILD_DEMOS)
  # What draws sheets on the studio's page, embedded in the program as the page is.
  find_path(NUNO_THREE build/three.module.js PATHS /usr/share/javascript/three NO_DEFAULT_PATH)
  mark_as_advanced(NUNO_THREE)
  if(NOT NUNO_THREE)
    message(STATUS "No three.js here: fetching npm's three 0.111.0")
    FetchContent_Declare(three URL https://registry.npmjs.org/three/-/three-0.111.0.tgz)
    FetchContent_MakeAvailable(three)
    set(NUNO_THREE "${three_SOURCE_DIR}")
  endif()
  nuno_find_or_fetch(
    CLI11 2.1 CLI11::CLI11 https://github.com/CLIUtils/CLI11.git v2.1.2 HEADERS include)
endif()

if(NUNO_BUILD_TESTS)
  set(BUILD_GMOCK OFF)
  set(INSTALL_GTEST OFF)
  nuno_find_or_fetch(
    GTest 1.12 GTest::gtest https://github.com/google/googletest.git release-1.12.1)
endif()
