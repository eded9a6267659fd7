#include "device_list.hpp"
#include "open_cpu.hpp"

namespace skybark::tool {

backend_info list_cpu() {
    const cpu::device device;
    return {"cpu", "", {{0, device.device_name(), cpu_driver(), "C++20", device.limits()}}};
}

} // namespace skybark::tool
