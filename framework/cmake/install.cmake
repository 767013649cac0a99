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
install(DIRECTORY ${PROJECT_SOURCE_DIR}/experiments DESTINATION share/evodevo COMPONENT sdk
  FILES_MATCHING PATTERN "*.toml" PATTERN "*.obj" PATTERN results EXCLUDE PATTERN study EXCLUDE)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/tools/cluster/run.sbatch DESTINATION share/evodevo)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/evodevo RENAME copyright)

# Pages about the use of evodevo: each is installed under another name, with links that lead to what is installed. Other
# links become plain text, and pictures are left out.
set(pages
  plugins/README.md=operators.md
  experiments/README.md=experiments.md
  framework/commands/README.md=commands.md
  framework/archive/README.md=archive.md
  kernels/README.md=simulation.md
  tools/python/README.md=python.md
  framework/sdk/README.md=plugins.md)
foreach(page encoding variation devo fitness selection helpers trust)
  list(APPEND pages framework/sdk/${page}.md=${page}.md)
endforeach()

# evodevo_installed_link(RESULT PATH): where a file of the source tree is, seen from the installed pages; empty if it is
# not installed
function(evodevo_installed_link result path)
  set(link "")
  foreach(page ${pages})
    string(REPLACE "=" ";" page ${page})
    list(GET page 0 source)
    list(GET page 1 name)
    if(path STREQUAL source)
      set(link ${name})
    endif()
  endforeach()
  if(path MATCHES "^(framework/sdk|kernels/include)/(evodevo/.*)$")
    set(link ../../../include/${CMAKE_MATCH_2})
  elseif(path MATCHES "^experiments/.*\\.(toml|obj)$" AND NOT path MATCHES "^experiments/(results|study)/")
    set(link ../../evodevo/${path})
  endif()
  set(${result} "${link}" PARENT_SCOPE)
endfunction()

# evodevo_install_page(FILE NAME): installs a page under another name
function(evodevo_install_page file name)
  set(source ${PROJECT_SOURCE_DIR}/${file})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
  get_filename_component(folder ${source} DIRECTORY)
  file(READ ${source} text)
  # marks instead of brackets, which confuse CMake's lists
  string(ASCII 1 mark)
  string(ASCII 2 dead)
  string(REPLACE "](" "${mark}(" text "${text}")
  string(REGEX MATCHALL "${mark}\\([^)]*\\)" links "${text}")
  list(REMOVE_DUPLICATES links)
  foreach(link ${links})
    string(REGEX REPLACE "^.\\(([^#)]*)(#?[^)]*)\\)$" "\\1" target "${link}")
    set(anchor "${CMAKE_MATCH_2}")
    if(target STREQUAL "" OR target MATCHES "^[a-z]+:")
      continue()
    endif()
    get_filename_component(target ${target} ABSOLUTE BASE_DIR ${folder})
    file(RELATIVE_PATH target ${PROJECT_SOURCE_DIR} ${target})
    evodevo_installed_link(installed "${target}")
    if(installed)
      string(REPLACE "${link}" "${mark}(${installed}${anchor})" text "${text}")
    else()
      string(REPLACE "${link}" "${dead}" text "${text}")
    endif()
  endforeach()
  string(REGEX REPLACE "!\\[[^${dead}${mark}]*${dead}" "" text "${text}")
  string(REGEX REPLACE "\\[([^[${dead}${mark}]*)${dead}" "\\1" text "${text}")
  string(REPLACE "${mark}(" "](" text "${text}")
  set(page ${CMAKE_CURRENT_BINARY_DIR}/pages/${name})
  file(WRITE ${page} "${text}")
  install(FILES ${page} DESTINATION share/doc/evodevo COMPONENT sdk)
endfunction()
foreach(page ${pages})
  string(REPLACE "=" ";" page ${page})
  evodevo_install_page(${page})
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
