#include "meadow_command.hpp"
#include "open_cpu.hpp"

namespace skybark::tool {

result<void> make_meadow_on_cpu(meadow_job& job) {
    auto device = open_cpu(job.common);
    if (!device) {
        return failure(device.error());
    }
    return make_meadow(*device, job, cpu_driver());
}

} // namespace skybark::tool
