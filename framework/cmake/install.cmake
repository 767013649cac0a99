# Installs the command and everything that the authors of plugins need. evodevo_add_plugin() installs the operators.
include(CMakePackageConfigHelpers)
set(package_dir lib/cmake/evodevo)

# The installed command finds the libraries that a package brings, and otherwise CUDA's runtime at the same path as in the
# build. It is built with that path, because installation would change the file otherwise, and runs would seem to come from
# another build.
set_target_properties(evodevo PROPERTIES BUILD_WITH_INSTALL_RPATH ON
  INSTALL_RPATH "\$ORIGIN/../${EVODEVO_PLUGIN_DIR}/libraries" INSTALL_RPATH_USE_LINK_PATH ON)
if(EVODEVO_CUDA)
  # NVRTC loads another library by its name, for which a RUNPATH of the command would not count, but an RPATH does
  target_link_options(evodevo PRIVATE -Wl,--disable-new-dtags)
endif()
install(TARGETS evodevo evodevo_sdk evodevo_body EXPORT evodevo RUNTIME DESTINATION bin)
install(EXPORT evodevo NAMESPACE evodevo:: FILE evodevoTargets.cmake DESTINATION ${package_dir})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/framework/sdk/evodevo ${PROJECT_SOURCE_DIR}/kernels/include/evodevo
  DESTINATION include COMPONENT sdk FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/framework/template DESTINATION share/evodevo)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/experiments DESTINATION share/evodevo
  FILES_MATCHING PATTERN "*.toml" PATTERN "*.obj" PATTERN results EXCLUDE PATTERN study EXCLUDE)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/tools/cluster/run.sbatch DESTINATION share/evodevo)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/evodevo RENAME copyright)

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
foreach(page encoding variation devo fitness selection helpers trust)
  evodevo_install_page(framework/sdk/${page}.md ${page}.md)
endforeach()

# The viewer, if it was built, which requires Node.js. The packages that only bundle the page are left out.
install(DIRECTORY ${PROJECT_BINARY_DIR}/${EVODEVO_VIEWER_DIR} DESTINATION share/evodevo OPTIONAL
  PATTERN .* EXCLUDE PATTERN .bin EXCLUDE PATTERN @esbuild EXCLUDE PATTERN esbuild EXCLUDE
  PATTERN axe-core EXCLUDE PATTERN three EXCLUDE PATTERN uplot EXCLUDE)

# before version 1.0, a new minor version may change the headers that plugins include
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/evodevoConfigVersion.cmake COMPATIBILITY SameMinorVersion)
set(EVODEVO_GCC_ABI "")
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -dM -E -x c++ /dev/null OUTPUT_VARIABLE macros)
  string(REGEX MATCH "__GXX_ABI_VERSION 10([0-9]+)" macros "${macros}")
  set(EVODEVO_GCC_ABI ${CMAKE_MATCH_1})
  string(REGEX MATCH "^[0-9]+" EVODEVO_GCC_MAJOR ${CMAKE_CXX_COMPILER_VERSION})
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/evodevoConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/evodevoConfig.cmake @ONLY)
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/evodevoConfigVersion.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/evodevoConfig.cmake
  ${CMAKE_CURRENT_LIST_DIR}/evodevo_add_plugin.cmake
  ${CMAKE_CURRENT_LIST_DIR}/evodevo_plugin.map
  DESTINATION ${package_dir})
