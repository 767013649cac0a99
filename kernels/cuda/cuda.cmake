# The CUDA part of the simulation core. Kernels are compiled at run time; their sources become part of the program.
set(embedded
  cuda/device/check.cuh
  cuda/device/cluster.cuh
  cuda/device/full_block.cu
  cuda/device/mass_step.cuh
  cuda/device/materials/computed.cuh
  cuda/device/materials/table.cuh
  cuda/device/methods/implicit.cu
  cuda/device/methods/paper_euler.cuh
  cuda/device/methods/rk4.cuh
  cuda/device/methods/symplectic_euler.cuh
  cuda/device/methods/velocity_verlet.cuh
  cuda/device/methods/xpbd.cu
  cuda/device/neighbours.cu
  cuda/device/resident.cu
  cuda/device/resident.cuh
  cuda/device/sampling.cuh
  cuda/device/springs.cuh
  cuda/device/streamed/block.cuh
  cuda/device/streamed/gather.cuh
  cuda/device/streamed/sample_streamed.cu
  cuda/device/streamed/sampling_streamed.cuh
  cuda/device/streamed/streamed.cu
  cuda/device/streamed/streamed.cuh
  cuda/layout/feature_list.hpp
  cuda/layout/fixed_point.hpp
  cuda/layout/formats.hpp
  cuda/layout/point_clouds.hpp
  physics/arithmetic.hpp
  physics/energy_bound.hpp
  physics/material_code.hpp
  physics/physics.hpp)
set(embedded_sources ${CMAKE_CURRENT_BINARY_DIR}/embedded_sources.cpp)

# evodevo_embed(OUTPUT HEADER FUNCTION SOURCES...): writes a C++ file with FUNCTION, declared in HEADER, which returns the
# texts of SOURCES (relative to the current source folder)
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

evodevo_embed(${embedded_sources} cuda/runtime/compiler.hpp evodevo::cuda::embedded_sources ${embedded})

set(cuda_sources
  cuda/layout/arrangement/arranged_body.cpp
  cuda/layout/arrangement/arrangement.cpp
  cuda/layout/arrangement/outline.cpp
  cuda/layout/arrangement/ownership.cpp
  cuda/layout/arrangement/partition.cpp
  cuda/layout/arrangement/row_order.cpp
  cuda/layout/arrangement/shape.cpp
  cuda/layout/features.cpp
  cuda/layout/force_range.cpp
  cuda/layout/resident.cpp
  cuda/layout/resident_packing.cpp
  cuda/layout/sampling.cpp
  cuda/layout/streamed.cpp
  cuda/runtime/cache.cpp
  cuda/runtime/clusters.cpp
  cuda/runtime/compiler.cpp
  cuda/runtime/cuda_neighbours.cpp
  cuda/runtime/cuda_simulator.cpp
  cuda/runtime/device.cpp
  cuda/runtime/device_resources.cpp
  cuda/runtime/error.cpp
  cuda/runtime/kernels.cpp
  cuda/runtime/memory_store.cpp
  cuda/runtime/portion.cpp
  ${embedded_sources})
target_sources(evodevo_kernels PRIVATE ${cuda_sources})
set_source_files_properties(${cuda_sources} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # several have private names alike
target_compile_definitions(evodevo_kernels PUBLIC EVODEVO_CUDA)
target_link_libraries(evodevo_kernels PRIVATE CUDA::cudart CUDA::nvrtc)
