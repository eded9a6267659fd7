#pragma once
// One OpenGL context, as this backend sees it: its functions, its limits, the few objects that
// every pattern shares, and the programs compiled so far.
//
// Everything is made when the device is made or when a kernel is first used: after that, a frame
// like the last one creates no object. Objects are reached by name (direct state access), so that
// only what a draw or a dispatch itself needs is ever bound; see state.hpp.

#include <skybark/core/backend.hpp>
#include <skybark/core/hooks.hpp>
#include <skybark/opengl/functions.hpp>
#include <skybark/opengl/programs/own_arguments.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/common.hpp>
#include <memory>
#include <vector>

namespace skybark::opengl {

/// A context that somebody else made: OpenGL 4.5 core or later, current in this thread whenever the
/// device or what it made is used or destroyed, with no query of primitives active and no
/// conditional rendering. Nothing of it is owned.
struct description {
    get_procedure get_proc_address = nullptr; ///< of the library that the context comes from
    void* user = nullptr;                     ///< given to both functions
    /// Optional: makes the context current where it is not, called at the start of every operation.
    bool (*make_current)(void* user) = nullptr;
    /// Optional: kept until the device is gone.
    std::shared_ptr<void> owner;
    /// The most that a texture may take which a drawn accumulation draws into. Layers of a volume
    /// that would need more are drawn in several turns.
    std::uint64_t max_target_bytes = std::uint64_t{1} << 30;
    skybark::hooks hooks = {};
    /// All that we create gets a name that begins with "skybark" (glObjectLabel), and every pattern
    /// is a group (glPushDebugGroup), which a debug callback hears of as notifications.
    bool debug_labels = false;
};

namespace detail {

/// A part of a buffer by its OpenGL name. A name of 0 stands for nothing.
struct bound_range {
    gl::handle buffer = 0;
    std::ptrdiff_t offset = 0;
    std::ptrdiff_t size = 0;
};

struct shader_stage {
    gl::token type = 0;
    std::string_view text;
};

/// What drawn accumulations draw into: floats, two to a voxel. Kept until a larger size is needed.
struct sum_targets {
    gl::handle tiles = 0;  ///< a 2-D texture, all layers side by side
    gl::handle layers = 0; ///< a 3-D texture
    glm::uvec2 tiles_size{0};
    glm::uvec3 layers_size{0};
    gl::handle tiles_frame = 0;  ///< the framebuffer of `tiles`
    gl::handle layers_frame = 0; ///< of all layers of `layers` at once
    gl::handle layer_frame = 0;  ///< of one of them
};

/// Of a texture of two floats a pixel or voxel.
[[nodiscard]] constexpr std::uint64_t sum_bytes(const glm::uvec3& size) {
    return std::uint64_t{8} * size.x * size.y * size.z;
}

/// What peels draw into. Kept until another size is needed.
struct layer_target {
    gl::handle fragments = 0; ///< a texture of two words a pixel: a triangle, the bits of a depth
    gl::handle depth = 0;
    gl::handle frame = 0; ///< the framebuffer of both
    glm::uvec2 size{0};
};

/// A buffer that grows where it must, and is kept.
struct scratch_buffer {
    gl::handle name = 0;
    std::uint64_t bytes = 0;
};

/// What bundles of rays are resolved with; see resolve.hpp. Drivers read whole texels faster than
/// words, so that two of the buffers are seen as textures as well.
struct resolve_objects {
    scratch_buffer starts;
    scratch_buffer corners;
    scratch_buffer entries;
    gl::handle corner_texels = 0;
    gl::handle entry_texels = 0;
    gl::handle shown_corners = 0; ///< the buffers that the textures show
    gl::handle shown_entries = 0;
};

/// What the patterns share. All of it lives as long as the context's device.
struct shared_objects {
    gl::handle vertex_array = 0;
    gl::handle feedback = 0;
    gl::handle nothing = 0;   ///< a framebuffer without attachments, for draws that draw nothing
    gl::handle target = 0;    ///< the framebuffer of `draw`
    gl::handle scratch = 0;   ///< 16 bytes, bound in the place of an empty view
    gl::handle arguments = 0; ///< of an indirect call, 32 bytes
    gl::handle parameters = 0;
    scratch_buffer ranges;
    scratch_buffer scan_sums;
    scratch_buffer sort_pairs;
    scratch_buffer sort_counts;
    sum_targets sums;
    layer_target layer;
    resolve_objects resolve;
    gl::handle written = 0;               ///< a query
    gl::handle generated = 0;             ///< a query
    std::array<gl::handle, 4> samplers{}; ///< 2 · linear + repeat
};

/// OpenGL 4.5 guarantees this much to a geometry shader; more would not link everywhere.
inline constexpr std::uint32_t max_geometry_components = 1024;
inline constexpr std::uint32_t max_geometry_vertices = 256;
/// And 64 components to a vertex that transform feedback takes.
inline constexpr std::size_t max_feedback_vertex_bytes = 256;

inline constexpr std::size_t header_bytes = 16;
inline constexpr std::size_t parameter_bytes = header_bytes + max_kernel_bytes;
inline constexpr std::uint32_t parameter_slots = 64;

[[nodiscard]] inline std::string_view error_name(gl::token code) {
    switch (code) {
    case gl::invalid_enum:
        return "GL_INVALID_ENUM";
    case gl::invalid_value:
        return "GL_INVALID_VALUE";
    case gl::invalid_operation:
        return "GL_INVALID_OPERATION";
    case gl::invalid_framebuffer_operation:
        return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case gl::out_of_memory:
        return "GL_OUT_OF_MEMORY";
    case gl::context_lost:
        return "GL_CONTEXT_LOST";
    default:
        return "an error unknown to OpenGL 4.5";
    }
}

class context {
  public:
    [[nodiscard]] static result<std::unique_ptr<context>> create(description given);
    ~context();
    context(const context&) = delete;
    context& operator=(const context&) = delete;

    /// Makes the context current where the description says how, and says whether it still lives.
    [[nodiscard]] result<void> enter();
    /// Forgets errors that happened before: they are the caller's, not ours.
    void forget_errors();
    /// The worst error since the last call, and whether the context still lives.
    [[nodiscard]] result<void> check(std::string_view doing);

    /// `what` says what for.
    [[nodiscard]] result<gl::handle> create_buffer(std::uint64_t bytes, const char* what);
    void destroy_buffer(gl::handle buffer);
    void destroy_texture(gl::handle texture);

    /// The program of these stages, compiled when it is first asked for. `max_vertices` specialises
    /// a geometry shader. The texts must outlive the context: kernels' programs are constants.
    [[nodiscard]] result<gl::handle> find_program(std::span<const shader_stage> stages,
                                                  std::uint32_t max_vertices = 0);

    /// Puts a header and a kernel's bytes where a uniform block can read them.
    [[nodiscard]] bound_range write_parameters(const std::array<std::uint32_t, 4>& header,
                                               std::span<const std::byte> kernel);
    /// Puts ranges where levels.comp reads them.
    [[nodiscard]] result<bound_range> write_ranges(std::span<const range> ranges);
    /// Makes a buffer at least so large; its content is undefined afterwards.
    [[nodiscard]] result<void> grow(scratch_buffer& buffer, std::uint64_t bytes);

    /// The name of one of our own objects, where the description asks for names.
    void label(gl::token kind, gl::handle object, const char* what, std::uint64_t bytes = 0) const;
    [[nodiscard]] bool labels() const noexcept { return description_.debug_labels; }
    [[nodiscard]] const hooks& watchers() const noexcept { return description_.hooks; }
    template <class Text>
    void say(log_level level, Text&& text) const {
        log(description_.hooks, level, text);
    }
    void say_made(const char* what, std::uint64_t bytes) const;

    /// Makes `objects.sums.tiles`, or `layers`, at least so large along each side: both keep what
    /// they have had, so that volumes of several sizes take turns without making textures. Where
    /// that would be more than max_target_bytes, exactly so large.
    [[nodiscard]] result<void> size_tiles(const glm::uvec2& wanted);
    [[nodiscard]] result<void> size_layers(const glm::uvec3& wanted);

    /// Makes the textures of `objects.resolve` show its buffers.
    void show_resolve_buffers();

    /// Makes the textures of `objects.layer` exactly so large.
    [[nodiscard]] result<void> size_layer(const glm::uvec2& size);

    /// What `draw` draws into. Attachments stay until they change, are destroyed, or `detach`.
    void attach(gl::handle color, gl::handle depth);
    void detach() { attach(0, 0); }

    gl::functions gl;
    device_limits limits;
    std::uint32_t max_layers = 0;        ///< of a framebuffer
    std::uint32_t max_buffer_texels = 0; ///< of a buffer texture
    std::uint64_t max_target_bytes = 0;  ///< as described
    device_traffic traffic;
    device_usage usage;
    shared_objects objects;
    std::string renderer;
    bool on_cpu = false;            ///< the renderer is Mesa's in software, or on top of it
    bool watched = false;           ///< patterns have zones or groups
    const char* current = "device"; ///< the one that is recorded: programs are named by it

  private:
    struct program_entry {
        std::array<const char*, 2> texts{};
        std::uint32_t max_vertices = 0;
        gl::handle program = 0;
    };

    explicit context(description given) : description_(std::move(given)) {}

    [[nodiscard]] result<void> load();
    [[nodiscard]] result<void> require_version() const;
    [[nodiscard]] result<void> require_limits();
    [[nodiscard]] int integer(gl::token name) const;
    void create_objects();
    [[nodiscard]] failure lose();
    [[nodiscard]] result<gl::handle> compile(const shader_stage& stage,
                                             std::uint32_t max_vertices) const;
    [[nodiscard]] result<gl::handle> link(std::span<const shader_stage> stages,
                                          std::uint32_t max_vertices) const;

    description description_;
    std::vector<program_entry> programs_;
    std::uint32_t parameter_stride_ = 256;
    std::uint32_t next_parameters_ = 0;
    gl::handle attached_color_ = 0;
    gl::handle attached_depth_ = 0;
    bool loaded_ = false;
    bool lost_ = false;
};

inline result<std::unique_ptr<context>> context::create(description given) {
    std::unique_ptr<context> made(new context(std::move(given)));
    made->watched = made->watchers().has_zones() || made->labels();
    if (auto done = made->load(); !done) {
        return failure(done.error());
    }
    made->forget_errors();
    if (auto done = made->require_limits(); !done) {
        return failure(done.error());
    }
    made->create_objects();
    if (auto done = made->check("making the objects of a device"); !done) {
        return failure(done.error());
    }
    made->current = "arguments";
    const shader_stage own[] = {{gl::compute_shader, arguments_comp}};
    if (auto program = made->find_program(own); !program) {
        return failure(program.error());
    }
    made->say(log_level::info, [&] { return "The opengl device is " + made->renderer + "."; });
    return made;
}

inline result<void> context::load() {
    if (description_.get_proc_address == nullptr) {
        return fail(error_code::bad_input, "The description of an OpenGL context has no "
                                           "get_proc_address.");
    }
    if (description_.make_current != nullptr && !description_.make_current(description_.user)) {
        return fail(error_code::unavailable, "The OpenGL context cannot be made current.");
    }
    const char* missing = gl::load(gl, description_.get_proc_address, description_.user);
    // Without these not even the version can be asked for.
    if (gl.get_string == nullptr || gl.get_integer == nullptr) {
        return fail(error_code::unavailable, "get_proc_address knows no glGetString.");
    }
    if (auto done = require_version(); !done) {
        return done;
    }
    if (missing != nullptr) {
        return fail(error_code::unavailable,
                    std::string("The OpenGL context has no function ") + missing + ".");
    }
    loaded_ = true;
    return {};
}

inline result<void> context::require_version() const {
    const auto* version = reinterpret_cast<const char*>(gl.get_string(gl::version));
    if (version == nullptr) {
        return fail(error_code::unavailable, "No OpenGL context is current in this thread.");
    }
    // The numbers are OpenGL ES's own where the text begins so; 3.0 is the oldest that has them.
    const std::string_view text(version);
    const int major = integer(gl::major_version);
    const int minor = integer(gl::minor_version);
    const bool core = (integer(gl::context_profile_mask) & int{gl::context_core_profile_bit}) != 0;
    if (text.starts_with("OpenGL ES") || major < 4 || (major == 4 && minor < 5) || !core) {
        return fail(error_code::unavailable,
                    "The OpenGL backend needs OpenGL 4.5 core; this context is \"" +
                        std::string(text) + "\"" + (core ? "." : ", not of the core profile."));
    }
    return {};
}

inline int context::integer(gl::token name) const {
    int value = 0;
    gl.get_integer(name, &value);
    return value;
}

inline result<void> context::require_limits() {
    struct requirement {
        gl::token name;
        int least;
        const char* text;
    };
    // OpenGL 4.5 guarantees 8 bindings, and none to a geometry shader. Skeletons use 8 to 11.
    const requirement needed[] = {
        {gl::max_shader_storage_buffer_bindings, 12, "storage buffer bindings"},
        {gl::max_compute_shader_storage_blocks, 8, "storage buffers in a compute shader"},
        {gl::max_geometry_shader_storage_blocks, 8, "storage buffers in a geometry shader"},
        {gl::max_vertex_shader_storage_blocks, 8, "storage buffers in a vertex shader"},
        {gl::max_fragment_shader_storage_blocks, 8, "storage buffers in a fragment shader"},
        {gl::max_image_units, 8, "image units"},
        {gl::max_fragment_image_uniforms, 4, "images in a fragment shader"},
    };
    for (const requirement& each : needed) {
        if (const int has = integer(each.name); has < each.least) {
            return fail(error_code::unavailable,
                        "The OpenGL backend needs " + std::to_string(each.least) + " " + each.text +
                            "; this context has " + std::to_string(has) + ".");
        }
    }
    std::int64_t block = 0;
    gl.get_integer64(gl::max_shader_storage_block_size, &block);
    limits.max_buffer_bytes = static_cast<std::uint64_t>(block);
    // Transform feedback asks for multiples of 4, which multiples of 16 are.
    limits.view_alignment = static_cast<std::uint64_t>(
        std::max(16, integer(gl::shader_storage_buffer_offset_alignment)));
    // 2³¹ elements are 2²⁵ workgroups, whose numbers do not wrap in 32 bits.
    limits.max_elements = std::uint64_t{1} << 31;
    limits.max_image_size = static_cast<std::uint32_t>(integer(gl::max_texture_size));
    // More than 65,535 groups are not dispatched, and a volume's rows are groups.
    limits.max_volume_size =
        static_cast<std::uint32_t>(std::min(integer(gl::max_3d_texture_size), 65535));
    limits.accumulate_routes =
        route_bit(accumulate_route::direct) | route_bit(accumulate_route::tiles_copied) |
        route_bit(accumulate_route::tiles_drawn) | route_bit(accumulate_route::layers);
    max_target_bytes = description_.max_target_bytes;
    max_buffer_texels = static_cast<std::uint32_t>(integer(gl::max_texture_buffer_size));
    max_layers = static_cast<std::uint32_t>(integer(gl::max_framebuffer_layers));
    parameter_stride_ = static_cast<std::uint32_t>(
        std::max(int{parameter_bytes}, integer(gl::uniform_buffer_offset_alignment)));
    const auto* name = reinterpret_cast<const char*>(gl.get_string(gl::renderer));
    const auto* version = reinterpret_cast<const char*>(gl.get_string(gl::version));
    renderer = std::string(name == nullptr ? "?" : name) + ", OpenGL " +
               (version == nullptr ? "?" : version);
    on_cpu = renderer.find("llvmpipe") != std::string::npos ||
             renderer.find("softpipe") != std::string::npos;
    return {};
}

inline void context::create_objects() {
    gl.create_vertex_arrays(1, &objects.vertex_array);
    gl.create_transform_feedbacks(1, &objects.feedback);
    gl.create_framebuffers(1, &objects.nothing);
    gl.named_framebuffer_parameter(objects.nothing, gl::framebuffer_default_width, 1);
    gl.named_framebuffer_parameter(objects.nothing, gl::framebuffer_default_height, 1);
    gl.create_framebuffers(1, &objects.target);
    gl.create_framebuffers(1, &objects.sums.tiles_frame);
    gl.create_framebuffers(1, &objects.sums.layers_frame);
    gl.create_framebuffers(1, &objects.sums.layer_frame);
    gl.create_framebuffers(1, &objects.layer.frame);
    gl.create_textures(gl::texture_target_buffer, 1, &objects.resolve.corner_texels);
    gl.create_textures(gl::texture_target_buffer, 1, &objects.resolve.entry_texels);
    gl.create_queries(gl::transform_feedback_primitives_written, 1, &objects.written);
    gl.create_queries(gl::primitives_generated, 1, &objects.generated);
    const auto storage = [this](gl::handle& buffer, std::uint64_t bytes) {
        gl.create_buffers(1, &buffer);
        gl.named_buffer_storage(buffer, static_cast<std::ptrdiff_t>(bytes), nullptr,
                                gl::dynamic_storage_bit);
    };
    storage(objects.scratch, 16);
    storage(objects.arguments, 32);
    storage(objects.parameters, std::uint64_t{parameter_stride_} * parameter_slots);
    label(gl::object_vertex_array, objects.vertex_array, "vertex array");
    label(gl::transform_feedback, objects.feedback, "transform feedback");
    label(gl::object_framebuffer, objects.nothing, "framebuffer of nothing");
    label(gl::object_framebuffer, objects.target, "framebuffer of draws");
    label(gl::object_framebuffer, objects.sums.tiles_frame, "framebuffer of tiles");
    label(gl::object_framebuffer, objects.sums.layers_frame, "framebuffer of layers");
    label(gl::object_framebuffer, objects.sums.layer_frame, "framebuffer of a layer");
    label(gl::object_framebuffer, objects.layer.frame, "framebuffer of peels");
    label(gl::object_texture, objects.resolve.corner_texels, "texels of corners");
    label(gl::object_texture, objects.resolve.entry_texels, "texels of entries");
    label(gl::object_query, objects.written, "query of primitives written");
    label(gl::object_query, objects.generated, "query of primitives generated");
    label(gl::object_buffer, objects.scratch, "spare buffer");
    label(gl::object_buffer, objects.arguments, "indirect arguments");
    label(gl::object_buffer, objects.parameters, "parameters");
    gl.create_samplers(static_cast<int>(objects.samplers.size()), objects.samplers.data());
    for (std::size_t i = 0; i < objects.samplers.size(); ++i) {
        const gl::handle sampler = objects.samplers[i];
        label(gl::object_sampler, sampler, "sampler");
        const int filter = static_cast<int>((i & 2) != 0 ? gl::linear : gl::nearest);
        const int wrap = static_cast<int>((i & 1) != 0 ? gl::repeat : gl::clamp_to_edge);
        gl.sampler_parameter(sampler, gl::texture_min_filter, filter);
        gl.sampler_parameter(sampler, gl::texture_mag_filter, filter);
        gl.sampler_parameter(sampler, gl::texture_wrap_s, wrap);
        gl.sampler_parameter(sampler, gl::texture_wrap_t, wrap);
        gl.sampler_parameter(sampler, gl::texture_wrap_r, wrap);
    }
}

inline context::~context() {
    if (!loaded_ ||
        (description_.make_current != nullptr && !description_.make_current(description_.user))) {
        return;
    }
    for (const program_entry& entry : programs_) {
        gl.delete_program(entry.program);
    }
    const sum_targets& sums = objects.sums;
    const gl::handle buffers[] = {objects.scratch,
                                  objects.arguments,
                                  objects.parameters,
                                  objects.ranges.name,
                                  objects.scan_sums.name,
                                  objects.sort_pairs.name,
                                  objects.sort_counts.name,
                                  objects.resolve.starts.name,
                                  objects.resolve.corners.name,
                                  objects.resolve.entries.name};
    const gl::handle queries[] = {objects.written, objects.generated};
    const gl::handle framebuffers[] = {objects.nothing,   objects.target,   sums.tiles_frame,
                                       sums.layers_frame, sums.layer_frame, objects.layer.frame};
    const gl::handle textures[] = {sums.tiles,
                                   sums.layers,
                                   objects.layer.fragments,
                                   objects.layer.depth,
                                   objects.resolve.corner_texels,
                                   objects.resolve.entry_texels};
    gl.delete_buffers(static_cast<int>(std::size(buffers)), buffers);
    gl.delete_queries(2, queries);
    gl.delete_framebuffers(6, framebuffers);
    gl.delete_textures(static_cast<int>(std::size(textures)), textures);
    gl.delete_samplers(static_cast<int>(objects.samplers.size()), objects.samplers.data());
    gl.delete_transform_feedbacks(1, &objects.feedback);
    gl.delete_vertex_arrays(1, &objects.vertex_array);
}

inline void context::label(gl::token kind, gl::handle object, const char* what,
                           std::uint64_t bytes) const {
    if (labels()) {
        std::string text = std::string("skybark ") + what;
        if (bytes != 0) {
            text += " of " + std::to_string(bytes) + " bytes";
        }
        gl.object_label(kind, object, static_cast<int>(text.size()), text.data());
    }
}

inline void context::say_made(const char* what, std::uint64_t bytes) const {
    say(log_level::debug, [&] {
        return renderer + " has made one " + what + " of " + std::to_string(bytes) + " bytes.";
    });
}

inline failure context::lose() {
    if (!lost_) {
        say(log_level::error, [this] { return "The OpenGL context of " + renderer + " is lost."; });
    }
    lost_ = true;
    return fail(error_code::device_lost, "The OpenGL context of " + renderer + " is lost.");
}

inline result<void> context::enter() {
    if (lost_) {
        return lose();
    }
    if (description_.make_current != nullptr && !description_.make_current(description_.user)) {
        return fail(error_code::unavailable, "The OpenGL context cannot be made current.");
    }
    return {};
}

inline void context::forget_errors() {
    // Bounded: a lost context may go on reporting that it is.
    for (int i = 0; i < 16 && gl.get_error() != gl::no_error; ++i) {
    }
}

inline result<void> context::check(std::string_view doing) {
    if (lost_ || gl.get_graphics_reset_status() != gl::no_error) {
        return lose();
    }
    gl::token worst = gl::no_error;
    for (int i = 0; i < 16; ++i) {
        const gl::token code = gl.get_error();
        if (code == gl::no_error) {
            break;
        }
        if (code == gl::context_lost) {
            return lose();
        }
        worst = worst == gl::out_of_memory ? worst : code;
    }
    if (worst == gl::no_error) {
        return {};
    }
    return fail(worst == gl::out_of_memory ? error_code::out_of_memory : error_code::bad_input,
                "OpenGL reported " + std::string(error_name(worst)) + " while " +
                    std::string(doing) + ".");
}

inline result<gl::handle> context::create_buffer(std::uint64_t bytes, const char* what) {
    // Storage of no bytes is an error in OpenGL; 16 keep the last vec4 of a block readable.
    const std::uint64_t allocated = std::max<std::uint64_t>((bytes + 15) / 16 * 16, 16);
    if (bytes > std::uint64_t{1} << 62) {
        return fail(error_code::out_of_memory,
                    "A buffer of " + std::to_string(bytes) + " bytes is larger than any memory.");
    }
    forget_errors();
    gl::handle buffer = 0;
    gl.create_buffers(1, &buffer);
    label(gl::object_buffer, buffer, what, bytes);
    gl.named_buffer_storage(buffer, static_cast<std::ptrdiff_t>(allocated), nullptr,
                            gl::dynamic_storage_bit);
    if (auto done = check("making a buffer of " + std::to_string(bytes) + " bytes"); !done) {
        gl.delete_buffers(1, &buffer);
        say(log_level::warning, [&] { return done.error().message; });
        return failure(done.error());
    }
    say_made(what, allocated);
    gl.clear_named_buffer_data(buffer, gl::r32ui, gl::red_integer, gl::unsigned_int, nullptr);
    return buffer;
}

inline void context::destroy_buffer(gl::handle buffer) {
    if (enter()) {
        gl.delete_buffers(1, &buffer);
    }
}

inline void context::destroy_texture(gl::handle texture) {
    if (enter()) {
        // A framebuffer that is not bound keeps what was deleted alive.
        if (texture == attached_color_ || texture == attached_depth_) {
            detach();
        }
        gl.delete_textures(1, &texture);
    }
}

inline result<gl::handle> context::compile(const shader_stage& stage,
                                           std::uint32_t max_vertices) const {
    // A #define may only follow #version, which is the text's first line.
    const std::size_t line = stage.text.find('\n') + 1;
    const std::string head =
        std::string(stage.text.substr(0, line)) +
        (max_vertices != 0 ? "#define SKYBARK_MAX_VERTICES " + std::to_string(max_vertices) + "\n"
                           : "");
    const char* texts[] = {head.data(), stage.text.data() + line};
    const int lengths[] = {static_cast<int>(head.size()),
                           static_cast<int>(stage.text.size() - line)};
    const gl::handle shader = gl.create_shader(stage.type);
    gl.shader_source(shader, 2, texts, lengths);
    label(gl::object_shader, shader, current);
    gl.compile_shader(shader);
    int good = 0;
    gl.get_shader(shader, gl::compile_status, &good);
    if (good != 0) {
        return shader;
    }
    int length = 0;
    gl.get_shader(shader, gl::info_log_length, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    gl.get_shader_info_log(shader, length, &length, log.data());
    log.resize(static_cast<std::size_t>(std::max(length, 0)));
    gl.delete_shader(shader);
    return fail(error_code::shader_rejected, renderer + " would not compile a shader: " + log);
}

inline result<gl::handle> context::link(std::span<const shader_stage> stages,
                                        std::uint32_t max_vertices) const {
    const gl::handle program = gl.create_program();
    label(gl::object_program, program, current);
    for (const shader_stage& stage : stages) {
        auto shader = compile(stage, stage.type == gl::geometry_shader ? max_vertices : 0);
        if (!shader) {
            gl.delete_program(program);
            return shader;
        }
        gl.attach_shader(program, *shader);
        gl.delete_shader(*shader); // when the program is
    }
    gl.link_program(program);
    int good = 0;
    gl.get_program(program, gl::link_status, &good);
    if (good != 0) {
        return program;
    }
    int length = 0;
    gl.get_program(program, gl::info_log_length, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    gl.get_program_info_log(program, length, &length, log.data());
    log.resize(static_cast<std::size_t>(std::max(length, 0)));
    gl.delete_program(program);
    return fail(error_code::shader_rejected, renderer + " would not link a program: " + log);
}

inline result<gl::handle> context::find_program(std::span<const shader_stage> stages,
                                                std::uint32_t max_vertices) {
    // A kernel's last text is its own, and with the first one it tells all programs apart.
    program_entry wanted{{stages.front().text.data(), stages.back().text.data()}, max_vertices, 0};
    for (const program_entry& entry : programs_) {
        if (entry.texts == wanted.texts && entry.max_vertices == max_vertices) {
            return entry.program;
        }
    }
    const double begin = watchers().log ? skybark::detail::milliseconds_now() : 0;
    auto program = link(stages, max_vertices);
    if (program) {
        wanted.program = *program;
        programs_.push_back(wanted);
        say(log_level::debug, [&] {
            return renderer + " has compiled \"" + current + "\" in " +
                   skybark::detail::milliseconds_text(skybark::detail::milliseconds_now() - begin) +
                   ".";
        });
    } else {
        say(log_level::error, [&] {
            return std::string("No program \"") + current + "\": " + program.error().message;
        });
    }
    return program;
}

inline bound_range context::write_parameters(const std::array<std::uint32_t, 4>& header,
                                             std::span<const std::byte> kernel) {
    // A ring, because a driver may have to wait or copy where it still reads what is replaced.
    std::array<std::byte, parameter_bytes> bytes{};
    std::memcpy(bytes.data(), header.data(), header_bytes);
    if (!kernel.empty()) {
        std::memcpy(bytes.data() + header_bytes, kernel.data(), kernel.size());
    }
    // std140 rounds a block up to whole vec4s.
    const std::size_t used = (header_bytes + kernel.size() + 15) / 16 * 16;
    const auto offset = static_cast<std::ptrdiff_t>(next_parameters_ * parameter_stride_);
    next_parameters_ = (next_parameters_ + 1) % parameter_slots;
    gl.named_buffer_sub_data(objects.parameters, offset, static_cast<std::ptrdiff_t>(used),
                             bytes.data());
    traffic.up += header_bytes + kernel.size();
    return {objects.parameters, offset, static_cast<std::ptrdiff_t>(used)};
}

inline result<void> context::grow(scratch_buffer& buffer, std::uint64_t bytes) {
    if (bytes <= buffer.bytes) {
        return {};
    }
    const std::uint64_t roomy = std::max<std::uint64_t>(bytes + bytes / 2, 4096);
    auto name = create_buffer(roomy, "buffer to work in");
    if (!name) {
        return failure(name.error());
    }
    gl.delete_buffers(1, &buffer.name);
    buffer = {*name, roomy};
    return {};
}

inline result<bound_range> context::write_ranges(std::span<const range> ranges) {
    if (auto done = grow(objects.ranges, ranges.size_bytes()); !done) {
        return failure(done.error());
    }
    const auto size = static_cast<std::ptrdiff_t>(ranges.size_bytes());
    gl.named_buffer_sub_data(objects.ranges.name, 0, size, ranges.data());
    traffic.up += ranges.size_bytes();
    return bound_range{objects.ranges.name, 0, size};
}

inline result<void> context::size_tiles(const glm::uvec2& wanted) {
    sum_targets& sums = objects.sums;
    const glm::uvec2 with_old = glm::max(wanted, sums.tiles_size);
    if (with_old == sums.tiles_size) {
        return {};
    }
    const glm::uvec2 size = sum_bytes({with_old, 1}) <= max_target_bytes ? with_old : wanted;
    gl.delete_textures(1, &sums.tiles);
    gl.create_textures(gl::texture_2d, 1, &sums.tiles);
    label(gl::object_texture, sums.tiles, "tiles to accumulate in");
    gl.texture_storage_2d(sums.tiles, 1, gl::rg32f, static_cast<int>(size.x),
                          static_cast<int>(size.y));
    gl.named_framebuffer_texture(sums.tiles_frame, gl::color_attachment0, sums.tiles, 0);
    auto done = check("making tiles of " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                      " pixels to accumulate in");
    sums.tiles_size = done ? size : glm::uvec2(0);
    if (done) {
        say_made("texture to accumulate in", sum_bytes({size, 1}));
    }
    return done;
}

inline result<void> context::size_layers(const glm::uvec3& wanted) {
    sum_targets& sums = objects.sums;
    const glm::uvec3 with_old = glm::max(wanted, sums.layers_size);
    if (with_old == sums.layers_size) {
        return {};
    }
    const glm::uvec3 size = sum_bytes(with_old) <= max_target_bytes ? with_old : wanted;
    gl.delete_textures(1, &sums.layers);
    gl.create_textures(gl::texture_3d, 1, &sums.layers);
    label(gl::object_texture, sums.layers, "layers to accumulate in");
    gl.texture_storage_3d(sums.layers, 1, gl::rg32f, static_cast<int>(size.x),
                          static_cast<int>(size.y), static_cast<int>(size.z));
    gl.named_framebuffer_texture(sums.layers_frame, gl::color_attachment0, sums.layers, 0);
    auto done =
        check("making layers of " + std::to_string(size.x) + " x " + std::to_string(size.y) +
              " x " + std::to_string(size.z) + " voxels to accumulate in");
    sums.layers_size = done ? size : glm::uvec3(0);
    if (done) {
        say_made("texture to accumulate in", sum_bytes(size));
    }
    return done;
}

inline void context::show_resolve_buffers() {
    const auto show = [this](gl::handle texture, gl::token format, gl::handle& shown,
                             gl::handle buffer) {
        if (shown != buffer) {
            gl.texture_buffer(texture, format, buffer);
            shown = buffer;
        }
    };
    resolve_objects& resolve = objects.resolve;
    show(resolve.corner_texels, gl::rgba32ui, resolve.shown_corners, resolve.corners.name);
    show(resolve.entry_texels, gl::r32ui, resolve.shown_entries, resolve.entries.name);
}

inline result<void> context::size_layer(const glm::uvec2& size) {
    layer_target& layer = objects.layer;
    if (layer.size == size) {
        return {};
    }
    const auto texture = [&](gl::handle& name, gl::token format, gl::token attachment) {
        gl.delete_textures(1, &name);
        gl.create_textures(gl::texture_2d, 1, &name);
        label(gl::object_texture, name, "layer to peel");
        gl.texture_storage_2d(name, 1, format, static_cast<int>(size.x), static_cast<int>(size.y));
        gl.named_framebuffer_texture(layer.frame, attachment, name, 0);
    };
    texture(layer.fragments, gl::rg32ui, gl::color_attachment0);
    texture(layer.depth, gl::depth_component32f, gl::depth_attachment);
    auto done = check("making a layer of " + std::to_string(size.x) + " x " +
                      std::to_string(size.y) + " pixels to peel");
    layer.size = done ? size : glm::uvec2(0);
    if (done) {
        say_made("pair of textures to peel", std::uint64_t{size.x} * size.y * 12);
    }
    return done;
}

inline void context::attach(gl::handle color, gl::handle depth) {
    if (color != attached_color_) {
        gl.named_framebuffer_texture(objects.target, gl::color_attachment0, color, 0);
        gl.named_framebuffer_draw_buffer(objects.target,
                                         color != 0 ? gl::color_attachment0 : gl::none);
        attached_color_ = color;
    }
    if (depth != attached_depth_) {
        gl.named_framebuffer_texture(objects.target, gl::depth_attachment, depth, 0);
        attached_depth_ = depth;
    }
}

/// A pattern: a zone of the hooks, and a debug group. Without both, a branch.
class pattern_scope {
  public:
    pattern_scope(context& c, const char* name) {
        c.current = name;
        if (c.watched) {
            begin(c, name);
        }
    }
    pattern_scope(const pattern_scope&) = delete;
    pattern_scope& operator=(const pattern_scope&) = delete;
    ~pattern_scope() {
        if (context_ != nullptr) {
            end();
        }
    }

  private:
    void begin(context& c, const char* name) {
        context_ = &c;
        if (const hooks& h = c.watchers(); h.begin_zone != nullptr) {
            h.begin_zone(h.user, name);
        }
        if (c.labels()) {
            // A push onto a full stack does nothing, and the pop would take a group of the
            // caller's.
            int depth = 0;
            int most = 0;
            c.gl.get_integer(gl::debug_group_stack_depth, &depth);
            c.gl.get_integer(gl::max_debug_group_stack_depth, &most);
            pushed_ = depth < most;
        }
        if (pushed_) {
            c.gl.push_debug_group(gl::debug_source_application, 0, -1, name);
        }
    }
    void end() {
        if (pushed_) {
            context_->gl.pop_debug_group();
        }
        if (const hooks& h = context_->watchers(); h.end_zone != nullptr) {
            h.end_zone(h.user);
        }
    }

    context* context_ = nullptr; ///< null: nobody looks
    bool pushed_ = false;
};

} // namespace detail
} // namespace skybark::opengl
