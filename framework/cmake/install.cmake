# Installs the command and everything that the authors of plugins need. evodevo_add_plugin() installs the operators.
include(CMakePackageConfigHelpers)
set(package_dir lib/cmake/evodevo)

# the installed command finds CUDA's runtime at the same path as in the build
set_target_properties(evodevo PROPERTIES INSTALL_RPATH_USE_LINK_PATH ON)
install(TARGETS evodevo evodevo_sdk evodevo_body EXPORT evodevo RUNTIME DESTINATION bin)
install(EXPORT evodevo NAMESPACE evodevo:: FILE evodevoTargets.cmake DESTINATION ${package_dir})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/framework/sdk/evodevo ${PROJECT_SOURCE_DIR}/kernels/include/evodevo
  DESTINATION include COMPONENT sdk FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/framework/template DESTINATION share/evodevo)

# evodevo_install_page(FILE NAME): installs a page under another name, with links that lead to the installed files
function(evodevo_install_page file name)
  set(source ${PROJECT_SOURCE_DIR}/${file})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
  file(READ ${source} text)
  string(REGEX REPLACE "\\]\\((\\.\\./\\.\\./kernels/include/)?evodevo/" "](../../../include/evodevo/" text "${text}")
  string(REPLACE "](README.md" "](plugins.md" text "${text}")
  set(page ${CMAKE_CURRENT_BINARY_DIR}/pages/${name})
  file(WRITE ${page} "${text}")
  install(FILES ${page} DESTINATION share/doc/evodevo COMPONENT sdk)
endfunction()
evodevo_install_page(plugins/README.md operators.md)
evodevo_install_page(framework/sdk/README.md plugins.md)
foreach(page encoding variation devo fitness selection helpers)
  evodevo_install_page(framework/sdk/${page}.md ${page}.md)
endforeach()

# the viewer, if it was built, which requires Node.js
install(DIRECTORY ${PROJECT_BINARY_DIR}/${EVODEVO_VIEWER_DIR} DESTINATION share/evodevo OPTIONAL)

# before version 1.0, a new minor version may change the headers that plugins include
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/evodevoConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/evodevoConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/evodevoConfig.cmake
  ${CMAKE_CURRENT_LIST_DIR}/evodevo_add_plugin.cmake
  ${CMAKE_CURRENT_LIST_DIR}/evodevo_plugin.map
  DESTINATION ${package_dir})
