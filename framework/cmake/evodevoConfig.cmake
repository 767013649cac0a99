# Read by find_package(evodevo). Provides the targets evodevo::sdk and evodevo::evodevo, and the function
# evodevo_add_plugin.
include("${CMAKE_CURRENT_LIST_DIR}/evodevoTargets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/evodevo_add_plugin.cmake")
