# Read by find_package(evodevo). Provides the targets evodevo::sdk and evodevo::evodevo, and the function
# evodevo_add_plugin.
include("${CMAKE_CURRENT_LIST_DIR}/evodevoTargets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/evodevo_add_plugin.cmake")

# The host refuses operators whose C++ ABI is not its own. GCC changes its ABI with each major version, but newer versions
# can be told to use that of an older one, which evodevo_add_plugin does.
set(evodevo_GCC_ABI "@EVODEVO_GCC_ABI@")
if(evodevo_GCC_ABI AND NOT (CMAKE_CXX_COMPILER_ID STREQUAL GNU
    AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL "@EVODEVO_GCC_MAJOR@"))
  message(WARNING "evodevo was built with GCC @EVODEVO_GCC_MAJOR@ and refuses operators that ${CMAKE_CXX_COMPILER_ID} "
    "${CMAKE_CXX_COMPILER_VERSION} builds; set CMAKE_CXX_COMPILER to GCC @EVODEVO_GCC_MAJOR@ or newer, such as "
    "g++-@EVODEVO_GCC_MAJOR@")
endif()
