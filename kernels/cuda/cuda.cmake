# The CUDA part of the simulation core. Kernels are compiled at run time; their sources become part of the program.
set(embedded cuda/resident.cu cuda/streamed.cu cuda/neighbours.cu cuda/check.cuh cuda/mass_step.cuh cuda/formats.hpp
  cuda/fixed_point.hpp cuda/point_clouds.hpp physics.hpp arithmetic.hpp)
list(TRANSFORM embedded PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE embedded_files)
set(embedded_sources ${CMAKE_CURRENT_BINARY_DIR}/embedded_sources.cpp)
add_custom_command(
  OUTPUT ${embedded_sources}
  COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_CURRENT_SOURCE_DIR} "-DSOURCES=${embedded}" -DOUTPUT=${embedded_sources}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/cuda/embed.cmake
  DEPENDS ${embedded_files} cuda/embed.cmake
  COMMENT "Embedding the kernels' sources"
  VERBATIM)

target_sources(evodevo_kernels PRIVATE
  cuda/arrangement.cpp
  cuda/cache.cpp
  cuda/compiler.cpp
  cuda/cuda_neighbours.cpp
  cuda/cuda_simulator.cpp
  cuda/device.cpp
  cuda/error.cpp
  cuda/features.cpp
  cuda/kernels.cpp
  cuda/ownership.cpp
  cuda/portion.cpp
  cuda/resident.cpp
  cuda/row_order.cpp
  cuda/streamed.cpp
  ${embedded_sources})
target_compile_definitions(evodevo_kernels PUBLIC EVODEVO_CUDA)
target_link_libraries(evodevo_kernels PRIVATE CUDA::cudart CUDA::nvrtc)
