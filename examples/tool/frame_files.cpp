#include "frame_files.hpp"

#include "options.hpp"

#include <io/text_input.hpp>
#include <io/write_png.hpp>

namespace skybark::tool {

result<void> check_single_name(const std::string& out, std::string_view expected) {
    const auto name = frame_name::parse(out);
    if (name && name->is_numbered()) {
        return contradiction("-o is " + io::in_quotes(out) + ", with a place for a number; " +
                             std::string(expected));
    }
    return {};
}

result<frame_output> find_frame_output(const std::string& out, std::uint32_t frames,
                                       const std::string& asked, frame_name& name) {
    const std::string extension = extension_of(out);
    if (extension == ".glb" || extension == ".apng") {
        auto good = check_single_name(out, "expected a name without, since this kind of file "
                                           "holds all frames.");
        return good ? result<frame_output>(frame_output::together) : failure(good.error());
    }
    const auto parsed = frame_name::parse(out);
    if (!parsed) {
        return failure(parsed.error());
    }
    if (frames > 1 && !parsed->is_numbered()) {
        return contradiction(asked + ", but -o is " + io::in_quotes(out) +
                             "; expected a place for the frame's number in it, such as %04d, or a "
                             "name that ends in .glb or .apng.");
    }
    name = *parsed;
    return frame_output::numbered;
}

result<void> frame_files::write(const std::string& name, std::span<const std::uint8_t> rgba) const {
    return io::write_png(name, rgba, width_, height_);
}

result<void> frame_files::add(std::span<const std::uint8_t> rgba) {
    if (!animation_) {
        auto file = io::apng_writer::create(out_, width_, height_, frames_,
                                            io::delay_of(frames_per_second_));
        if (!file) {
            return failure(file.error());
        }
        animation_ = std::move(*file);
    }
    return animation_->add(rgba);
}

result<void> frame_files::commit() { return animation_ ? animation_->commit() : result<void>(); }

} // namespace skybark::tool
