# find_package(nuno) for other projects: nuno::core, nuno::native, nuno::box2d,
# nuno::bullet, nuno::formats, nuno::engines.
# A package can only name dependencies that it can find again, so not those that were fetched.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

if(NUNO_FETCHED)
  set(installable OFF)
else()
  set(installable ${PROJECT_IS_TOP_LEVEL})
endif()
option(NUNO_INSTALL "Install the libraries, their CMake package and the program" ${installable})
if(NOT NUNO_INSTALL)
  return()
endif()

set(package_directory "${CMAKE_INSTALL_LIBDIR}/cmake/nuno")

install(
  TARGETS nuno_core nuno_native nuno_box2d nuno_bullet nuno_formats nuno_engines
  EXPORT nuno
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(
  DIRECTORY core/include/ native_backend/include/ box2d_backend/include/ bullet_backend/include/
            formats/include/ engines/include/
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  FILES_MATCHING
  PATTERN "*.h")
install(EXPORT nuno NAMESPACE nuno:: FILE nuno-targets.cmake DESTINATION "${package_directory}")

configure_package_config_file(cmake/nuno-config.cmake.in nuno-config.cmake
                              INSTALL_DESTINATION "${package_directory}")
write_basic_package_version_file(nuno-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/nuno-config.cmake"
              "${PROJECT_BINARY_DIR}/nuno-config-version.cmake"
        DESTINATION "${package_directory}")

if(TARGET nuno)
  install(TARGETS nuno RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
  include(cmake/package.cmake)
endif()
