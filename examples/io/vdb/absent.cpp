// VDB files where OpenVDB wasn't found.

#include <io/text_input.hpp>
#include <io/vdb.hpp>

namespace skybark::io {

namespace {

failure fail_without(const std::string& path) {
    return fail(error_code::bad_input,
                in_quotes(path) + " is a VDB file, and this program was built without OpenVDB; "
                                  "expected one that was built where libopenvdb-dev is installed.");
}

} // namespace

result<density_grid> read_vdb(const std::string& path, std::string_view) {
    return fail_without(path);
}

result<void> write_vdb(const std::string& path, std::span<const vdb_volume>) {
    return fail_without(path);
}

} // namespace skybark::io
