#include "gather_command.hpp"
#include "open_cpu.hpp"

namespace skybark::tool {

result<void> gather_on_cpu(gather_job& job) {
    auto device = open_cpu(job.common);
    if (!device) {
        return failure(device.error());
    }
    return gather_light(*device, job, cpu_driver());
}

} // namespace skybark::tool
