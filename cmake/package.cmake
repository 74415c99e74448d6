# What a package holds beside the program and the libraries, and the .deb itself (`./run package`,
# or cpack in the build folder).

set(user_pages "${PROJECT_BINARY_DIR}/user_pages")
add_custom_command(
  OUTPUT "${user_pages}/made"
  COMMAND "${PROJECT_SOURCE_DIR}/packaging/write_user_pages" "$<TARGET_FILE:nuno>" "${user_pages}"
  COMMAND "${CMAKE_COMMAND}" -E touch "${user_pages}/made"
  DEPENDS nuno "${PROJECT_SOURCE_DIR}/packaging/write_user_pages"
  COMMENT "Writing man pages and completions"
  VERBATIM)
add_custom_target(nuno_user_pages ALL DEPENDS "${user_pages}/made")
install(DIRECTORY "${user_pages}/man/" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
install(FILES "${user_pages}/completions/nuno" DESTINATION share/bash-completion/completions)
install(FILES "${user_pages}/completions/_nuno" DESTINATION share/zsh/vendor-completions)
install(FILES "${user_pages}/completions/nuno.fish" DESTINATION share/fish/vendor_completions.d)
install(DIRECTORY demos/blender/nuno_throw DESTINATION share/blender/scripts/addons
        FILES_MATCHING PATTERN "*.py" PATTERN "*.toml")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME nuno)
set(CPACK_PACKAGE_CONTACT "The nuno authors <nuno@debian.invalid>"
    CACHE STRING "Maintainer of the package: name and address")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};nuno;ALL;/")

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(TARGET nuno_python)
  set(python "${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}")
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PACKAGE_DEPENDS
      "python3 (>= ${python}~), python3 (<< ${Python_VERSION_MAJOR}.${next}), python3-numpy")
endif()
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "ffmpeg, librsvg2-bin")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
    "blender, python3-distributed, libeigen3-dev, libfmt-dev, libpugixml-dev, libhwy-dev, libbox2d-dev, libbullet-dev"
)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "throw a cloth so that it arrives as it was drawn")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "An animator draws a cloth as it is and as it should be, and says when.
 nuno gives a flight that looks thrown rather than pulled: the program, a C++
 library, a Python module and an add-on for Blender.")
set(scripts "${PROJECT_SOURCE_DIR}/packaging/debian")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "${scripts}/postinst;${scripts}/prerm")

# As Debian has them: what is documented is compressed, without a time.
set(documents "${PROJECT_BINARY_DIR}/documents")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(packaging/debian/changelog.in "${documents}/changelog.Debian" @ONLY)
configure_file(packaging/debian/copyright "${documents}/copyright" COPYONLY)
configure_file(CHANGELOG.md "${documents}/changelog" COPYONLY)
execute_process(COMMAND gzip -9nf changelog changelog.Debian WORKING_DIRECTORY "${documents}")
install(FILES "${documents}/copyright" "${documents}/changelog.gz"
              "${documents}/changelog.Debian.gz" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(FILES packaging/debian/lintian-overrides DESTINATION share/lintian/overrides RENAME nuno)
include(CPack)
