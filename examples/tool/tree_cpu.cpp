#include "open_cpu.hpp"
#include "tree_command.hpp"

namespace skybark::tool {

result<void> make_tree_on_cpu(tree_job& job) {
    auto device = open_cpu(job.common);
    if (!device) {
        return failure(device.error());
    }
    return make_tree(*device, job, cpu_driver());
}

} // namespace skybark::tool
