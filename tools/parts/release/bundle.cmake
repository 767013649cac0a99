# CPack calls this script before it packs. It copies the shared libraries that the command needs and that other systems
# may lack into the package, with their licences. A Debian package depends on the packages of its libraries, so only
# those of CUDA, which Debian does not have in the versions that evodevo needs, are copied into it.
#
# The C and the C++ runtime always come from the system: an older copy would break what the system loads beside it.
cmake_minimum_required(VERSION 3.25)
set(prefix ${CPACK_TEMPORARY_INSTALL_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX})
set(CMAKE_GET_RUNTIME_DEPENDENCIES_PLATFORM linux+elf)
set(CMAKE_GET_RUNTIME_DEPENDENCIES_TOOL objdump)
file(GET_RUNTIME_DEPENDENCIES
  EXECUTABLES ${prefix}/bin/evodevo
  RESOLVED_DEPENDENCIES_VAR libraries
  PRE_EXCLUDE_REGEXES "^lib(c|m|dl|rt|pthread|gcc_s|stdc\\+\\+)\\.so" "^ld-linux")
if(CPACK_GENERATOR STREQUAL DEB)
  list(FILTER libraries INCLUDE REGEX "/lib(cudart|nvrtc)\\.so")
endif()

foreach(library IN LISTS libraries)
  if(library MATCHES "/libnvrtc\\.so")  # which loads another one by its name
    get_filename_component(folder ${library} REALPATH)
    get_filename_component(folder ${folder} DIRECTORY)
    file(GLOB builtins ${folder}/libnvrtc-builtins.so.*.*)
    list(APPEND libraries ${builtins})
  endif()
endforeach()
# file(COPY), because file(INSTALL) would heed DESTDIR, which CPack sets for some generators
foreach(library IN LISTS libraries)
  file(COPY ${library} DESTINATION ${prefix}/lib/evodevo/libraries FOLLOW_SYMLINK_CHAIN)
  get_filename_component(file ${library} REALPATH)
  get_filename_component(file ${file} NAME)
  execute_process(COMMAND dpkg-query -S */${file} OUTPUT_VARIABLE owner ERROR_QUIET)
  string(REGEX REPLACE "[:,].*" "" owner "${owner}")
  if(owner AND EXISTS /usr/share/doc/${owner}/copyright)
    file(MAKE_DIRECTORY ${prefix}/share/doc/evodevo/licences)
    file(COPY_FILE /usr/share/doc/${owner}/copyright ${prefix}/share/doc/evodevo/licences/${owner})
  endif()
endforeach()
