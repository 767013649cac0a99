// An empty kernel, whose blocks need a whole multiprocessor each. The host asks how many clusters of them a device has
// room for.
extern "C" __global__ void __launch_bounds__(1024, 1) evodevo_full_block() {}
