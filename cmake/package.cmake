# A Debian package: cmake --build --preset release --target package
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME dapple)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "${DAPPLE_MAINTAINER}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/package_folders.cmake)

# One package of two components; "plain" is what an installation by hand has in other places.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_COMPONENTS_ALL dapple debian)

set(CPACK_DEBIAN_PACKAGE_NAME dapple)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# What the program loads only when it needs it.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libosmesa6 (>= 22)")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "texture point-sampled scans by example")
set(CPACK_PACKAGE_DESCRIPTION
"Dapple grows a small sample image, the swatch, over a whole scan: every point
gets its colour. It works on points alone, without a mesh, texture coordinates
or a graphics card, and remembers for every point which texel of the swatch it
came from.

It reads PLY, OBJ and XYZ files, writes PLY with everything else that was in
the file, draws pictures without a display, and measures how well a result
resembles its swatch. Twelve swatches and a scan to begin with are included.")
include(CPack)
