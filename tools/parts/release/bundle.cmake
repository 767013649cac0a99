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
  # where Debian's Python looks; as deep as before, so that the module finds the operators and libraries
  file(GLOB module ${prefix}/lib/python3.*/site-packages/evodevo)
  if(module)
    file(MAKE_DIRECTORY ${prefix}/lib/python3/dist-packages)
    file(RENAME ${module} ${prefix}/lib/python3/dist-packages/evodevo)
    get_filename_component(emptied ${module}/../.. ABSOLUTE)
    file(REMOVE_RECURSE ${emptied})
  endif()
endif()

foreach(library IN LISTS libraries)
  if(library MATCHES "/libnvrtc\\.so")  # which loads another one by its name
    get_filename_component(folder ${library} REALPATH)
    get_filename_component(folder ${folder} DIRECTORY)
    file(GLOB builtins ${folder}/libnvrtc-builtins.so.*.*)
    list(APPEND libraries ${builtins})
  endif()
endforeach()
# Copies a licence, or another file, to share/doc/evodevo/licences/NAME in the package.
function(bring_licence file name)
  file(MAKE_DIRECTORY ${prefix}/share/doc/evodevo/licences)
  file(COPY_FILE ${file} ${prefix}/share/doc/evodevo/licences/${name})
endfunction()

# Brings NVIDIA's licence, which CUDA toolkits have as EULA.txt or, if they were made of Python packages, beside the
# description of the package that the library is from.
function(bring_licence_of_cuda library name)
  get_filename_component(folder ${library} DIRECTORY)
  set(licences "")
  foreach(above RANGE 3)
    file(GLOB found ${folder}/EULA.txt ${folder}/dist-info/nvidia_cuda_${name}-*/licenses/License.txt
      ${folder}/nvidia_cuda_${name}*.dist-info/licenses/License.txt)
    list(APPEND licences ${found})
    get_filename_component(folder ${folder} DIRECTORY)
  endforeach()
  if(NOT licences)
    message(FATAL_ERROR "${library}: its licence, which the package has to bring, was not found: expected EULA.txt in the "
      "CUDA toolkit's folder")
  endif()
  list(GET licences 0 licence)
  bring_licence(${licence} nvidia-cuda-${name})
endfunction()

# file(COPY), because file(INSTALL) would heed DESTDIR, which CPack sets for some generators
foreach(library IN LISTS libraries)
  file(COPY ${library} DESTINATION ${prefix}/lib/evodevo/libraries FOLLOW_SYMLINK_CHAIN)
  get_filename_component(path ${library} REALPATH)
  get_filename_component(file ${path} NAME)
  execute_process(COMMAND dpkg-query -S */${file} OUTPUT_VARIABLE owner ERROR_QUIET)
  string(REGEX REPLACE "[:,].*" "" owner "${owner}")
  if(file MATCHES "^lib(cudart|nvrtc)\\.so")
    string(REPLACE cudart runtime name ${CMAKE_MATCH_1})
    bring_licence_of_cuda(${path} ${name})
  elseif(owner AND EXISTS /usr/share/doc/${owner}/copyright)
    bring_licence(/usr/share/doc/${owner}/copyright ${owner})
  endif()
endforeach()
