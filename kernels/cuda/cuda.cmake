# The CUDA part of the simulation core. Kernels are compiled at run time; their sources become part of the program.
set(embedded cuda/resident.cu cuda/streamed.cu cuda/neighbours.cu cuda/block.cuh cuda/check.cuh cuda/mass_step.cuh
  cuda/resident.cuh cuda/streamed.cuh cuda/materials/computed.cuh cuda/materials/table.cuh cuda/methods/implicit.cu cuda/methods/paper_euler.cuh cuda/methods/rk4.cuh
  cuda/methods/symplectic_euler.cuh cuda/methods/velocity_verlet.cuh cuda/methods/xpbd.cu cuda/formats.hpp
  cuda/fixed_point.hpp cuda/point_clouds.hpp physics.hpp arithmetic.hpp energy_bound.hpp material_code.hpp)
set(embedded_sources ${CMAKE_CURRENT_BINARY_DIR}/embedded_sources.cpp)

# evodevo_embed(OUTPUT HEADER FUNCTION SOURCES...): the sources, relative to here, as what FUNCTION of HEADER gives
function(evodevo_embed output header function)
  set(script ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/embed.cmake)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE files)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_CURRENT_SOURCE_DIR} "-DSOURCES=${ARGN}" -DHEADER=${header}
      -DFUNCTION=${function} -DOUTPUT=${output} -P ${script}
    DEPENDS ${files} ${script}
    COMMENT "Embedding the kernels' sources"
    VERBATIM)
endfunction()

evodevo_embed(${embedded_sources} cuda/compiler.hpp evodevo::cuda::embedded_sources ${embedded})

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
  cuda/memory_store.cpp
  cuda/ownership.cpp
  cuda/portion.cpp
  cuda/resident.cpp
  cuda/row_order.cpp
  cuda/streamed.cpp
  ${embedded_sources})
target_compile_definitions(evodevo_kernels PUBLIC EVODEVO_CUDA)
target_link_libraries(evodevo_kernels PRIVATE CUDA::cudart CUDA::nvrtc)
