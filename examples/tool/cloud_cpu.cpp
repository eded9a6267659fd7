#include "cloud_command.hpp"
#include "open_cpu.hpp"

namespace skybark::tool {

result<void> make_cloud_on_cpu(cloud_job& job) {
    auto device = open_cpu(job.common);
    if (!device) {
        return failure(device.error());
    }
    return make_cloud(*device, job, cpu_driver());
}

} // namespace skybark::tool
