#include "cuda/runtime/error.hpp"

namespace evodevo::cuda {
namespace {

const char* remedy(cudaError_t result) {
  switch (result) {
    case cudaErrorInsufficientDriver:
      return "; install a newer NVIDIA driver";
    case cudaErrorNoDevice:
      return "; check that nvidia-smi lists a GPU and that CUDA_VISIBLE_DEVICES does not hide it";
    case cudaErrorMemoryAllocation:
      return "; end other programs that use that memory (nvidia-smi lists those on the GPU), or compute on the CPU";
    case cudaErrorNoKernelImageForDevice:
    case cudaErrorUnsupportedPtxVersion:
      return "; this GPU and the CUDA toolkit that the program was built with do not fit: build with a newer toolkit, "
             "or install a newer driver";
    case cudaErrorDevicesUnavailable:
      return "; another program holds the GPU exclusively (nvidia-smi lists it)";
    case cudaErrorSystemDriverMismatch:
      return "; the driver was updated while it was in use: restart the machine";
    case cudaErrorSystemNotReady:
      return "; the machine needs NVIDIA's fabric manager: start the service nvidia-fabricmanager";
    case cudaErrorECCUncorrectable:
      return "; the GPU's memory is damaged: reset the GPU (nvidia-smi --gpu-reset) or use another one";
    case cudaErrorIllegalAddress:
    case cudaErrorIllegalInstruction:
    case cudaErrorMisalignedAddress:
    case cudaErrorHardwareStackError:
    case cudaErrorLaunchFailure:
      return "; this is an error in evodevo or in the hardware: please report it with the experiment's file; nothing "
             "more can be computed on the device in this process";
    default:
      return "";
  }
}

}  // namespace

void check(cudaError_t result, const std::string& what) {
  if (result == cudaSuccess) return;
  cudaGetLastError();  // clears the failure, so that the next call does not report it again
  const std::string message = "CUDA: " + what + " failed: " + cudaGetErrorString(result) + " (" +
                              cudaGetErrorName(result) + ")" + remedy(result);
  if (result == cudaErrorMemoryAllocation) throw OutOfMemory(message);
  throw std::runtime_error(message);
}

}  // namespace evodevo::cuda
