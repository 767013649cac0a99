# What CPack packs: a tarball that can be unpacked anywhere, and a Debian package. tools/release makes and tries both.
set(CPACK_PACKAGE_VENDOR "The evodevo authors")
set(CPACK_PACKAGE_CONTACT "The evodevo authors")
set(CPACK_PACKAGE_DESCRIPTION "A robot is a body of masses and springs, some of which are muscles. A genome decides how the \
body is built, and the body goes on developing during its life. Every operator of the evolution is a plugin.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_GENERATOR TGZ DEB)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)

string(TOLOWER "${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}" platform)
set(variant "")
if(EVODEVO_CUDA)
  set(variant "-cuda")
  set(CPACK_DEBIAN_PACKAGE_PROVIDES evodevo)
  set(CPACK_DEBIAN_PACKAGE_CONFLICTS evodevo)
  set(CPACK_DEBIAN_PACKAGE_REPLACES evodevo)
endif()
set(CPACK_PACKAGE_FILE_NAME evodevo-${PROJECT_VERSION}-${platform}${variant})

set(CPACK_DEBIAN_PACKAGE_NAME evodevo${variant})
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# to build plugins, to draw and encode films, and for the Python package
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake, make, nodejs, chromium, ffmpeg, python3-numpy, python3-pandas")

set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/bundle.cmake)
include(CPack)
