// A device in somebody else's context: names and groups on all that it makes, log and zones.

#include "caller.hpp"
#include "support/every_pattern.hpp"
#include "support/hook_log.hpp"

#include <map>
#include <set>

namespace skybark::opengl::tests {
namespace {

using support::hook_log;

/// An object: what glObjectLabel calls its kind, and its name.
using object = std::pair<GLenum, GLuint>;

/// What passes between a device and OpenGL. There is one at a time: OpenGL's functions have no room
/// for a pointer of ours.
struct spy {
    caller_context* context = nullptr;
    std::map<object, std::string> alive; ///< what was made, and its name
    std::map<GLenum, int> made;
    std::set<std::string> groups;
    int open = 0;
    int deepest = 0;
    bool expects_names = true;
    bool reject_shaders = false;
    bool lose_context = false;
};
spy* current = nullptr;

template <class Pointer>
[[nodiscard]] Pointer real(const char* name) {
    return reinterpret_cast<Pointer>(current->context->find(name));
}

void note_made(GLenum kind, GLsizei count, const GLuint* names) {
    for (GLsizei i = 0; i < count; ++i) {
        EXPECT_TRUE(current->alive.try_emplace({kind, names[i]}).second) << "made twice";
        ++current->made[kind];
    }
}
void note_gone(GLenum kind, GLsizei count, const GLuint* names) {
    for (GLsizei i = 0; i < count; ++i) {
        if (names[i] != 0) {
            const auto at = current->alive.find({kind, names[i]});
            ASSERT_NE(at, current->alive.end()) << "deleted, but not made: " << kind;
            EXPECT_EQ(at->second.starts_with("skybark "), current->expects_names)
                << kind << ": " << at->second;
            current->alive.erase(at);
        }
    }
}

/// glCreateBuffers and those like it, by their names' place here.
constexpr const char* creators[] = {"glCreateBuffers", "glCreateVertexArrays",
                                    "glCreateTransformFeedbacks", "glCreateFramebuffers",
                                    "glCreateSamplers"};
constexpr const char* deleters[] = {
    "glDeleteBuffers",      "glDeleteVertexArrays", "glDeleteTransformFeedbacks",
    "glDeleteFramebuffers", "glDeleteSamplers",     "glDeleteTextures",
    "glDeleteQueries"};
constexpr GLenum kinds[] = {GL_BUFFER,      GL_VERTEX_ARRAY, GL_TRANSFORM_FEEDBACK,
                            GL_FRAMEBUFFER, GL_SAMPLER,      GL_TEXTURE,
                            GL_QUERY};

template <std::size_t I>
void APIENTRY create(GLsizei count, GLuint* names) {
    real<PFNGLCREATEBUFFERSPROC>(creators[I])(count, names);
    note_made(kinds[I], count, names);
}
template <std::size_t I>
void APIENTRY destroy(GLsizei count, const GLuint* names) {
    note_gone(kinds[I], count, names);
    real<PFNGLDELETEBUFFERSPROC>(deleters[I])(count, names);
}
void APIENTRY create_textures(GLenum target, GLsizei count, GLuint* names) {
    real<PFNGLCREATETEXTURESPROC>("glCreateTextures")(target, count, names);
    note_made(GL_TEXTURE, count, names);
}
void APIENTRY create_queries(GLenum target, GLsizei count, GLuint* names) {
    real<PFNGLCREATEQUERIESPROC>("glCreateQueries")(target, count, names);
    note_made(GL_QUERY, count, names);
}
GLuint APIENTRY create_shader(GLenum type) {
    const GLuint name = real<PFNGLCREATESHADERPROC>("glCreateShader")(type);
    note_made(GL_SHADER, 1, &name);
    return name;
}
void APIENTRY delete_shader(GLuint name) {
    note_gone(GL_SHADER, 1, &name);
    real<PFNGLDELETESHADERPROC>("glDeleteShader")(name);
}
GLuint APIENTRY create_program() {
    const GLuint name = real<PFNGLCREATEPROGRAMPROC>("glCreateProgram")();
    note_made(GL_PROGRAM, 1, &name);
    return name;
}
void APIENTRY delete_program(GLuint name) {
    note_gone(GL_PROGRAM, 1, &name);
    real<PFNGLDELETEPROGRAMPROC>("glDeleteProgram")(name);
}
void APIENTRY get_shader(GLuint shader, GLenum what, GLint* value) {
    real<PFNGLGETSHADERIVPROC>("glGetShaderiv")(shader, what, value);
    if (what == GL_COMPILE_STATUS && current->reject_shaders) {
        *value = 0;
    }
}
GLenum APIENTRY get_reset_status() {
    return current->lose_context
               ? GLenum{GL_GUILTY_CONTEXT_RESET}
               : real<PFNGLGETGRAPHICSRESETSTATUSPROC>("glGetGraphicsResetStatus")();
}
void APIENTRY object_label(GLenum kind, GLuint name, GLsizei length, const char* text) {
    const auto at = current->alive.find({kind, name});
    ASSERT_NE(at, current->alive.end()) << "a name for something else: " << text;
    at->second = length < 0 ? std::string(text) : std::string(text, std::size_t(length));
    real<PFNGLOBJECTLABELPROC>("glObjectLabel")(kind, name, length, text);
}
void APIENTRY push_group(GLenum source, GLuint id, GLsizei length, const char* text) {
    current->groups.insert(length < 0 ? std::string(text) : std::string(text, std::size_t(length)));
    current->deepest = std::max(current->deepest, ++current->open);
    real<PFNGLPUSHDEBUGGROUPPROC>("glPushDebugGroup")(source, id, length, text);
}
void APIENTRY pop_group() {
    EXPECT_GT(current->open, 0) << "a group ends that did not begin";
    --current->open;
    real<PFNGLPOPDEBUGGROUPPROC>("glPopDebugGroup")();
}

template <class Function>
[[nodiscard]] procedure as_procedure(Function* function) {
    return reinterpret_cast<procedure>(function);
}
template <std::size_t... I>
[[nodiscard]] procedure in_front_of(std::string_view name, std::index_sequence<I...>) {
    procedure found = nullptr;
    ((found = name == deleters[I] ? as_procedure(&destroy<I>) : found), ...);
    return found;
}
[[nodiscard]] procedure find(const char* text, void*) {
    const std::string_view name(text);
    const std::pair<std::string_view, procedure> others[] = {
        {creators[0], as_procedure(&create<0>)},
        {creators[1], as_procedure(&create<1>)},
        {creators[2], as_procedure(&create<2>)},
        {creators[3], as_procedure(&create<3>)},
        {creators[4], as_procedure(&create<4>)},
        {"glCreateTextures", as_procedure(&create_textures)},
        {"glCreateQueries", as_procedure(&create_queries)},
        {"glCreateShader", as_procedure(&create_shader)},
        {"glDeleteShader", as_procedure(&delete_shader)},
        {"glCreateProgram", as_procedure(&create_program)},
        {"glDeleteProgram", as_procedure(&delete_program)},
        {"glGetShaderiv", as_procedure(&get_shader)},
        {"glGetGraphicsResetStatus", as_procedure(&get_reset_status)},
        {"glObjectLabel", as_procedure(&object_label)},
        {"glPushDebugGroup", as_procedure(&push_group)},
        {"glPopDebugGroup", as_procedure(&pop_group)}};
    for (const auto& [known, function] : others) {
        if (name == known) {
            return function;
        }
    }
    if (const procedure found =
            in_front_of(name, std::make_index_sequence<std::size(deleters)>())) {
        return found;
    }
    EXPECT_FALSE(name.starts_with("glCreate") || name.starts_with("glGen") ||
                 name.starts_with("glDelete"))
        << name;
    return current->context->find(text);
}

class opengl_embedding : public testing::Test {
  protected:
    void SetUp() override {
        if (!context_.current()) {
            ASSERT_FALSE(required());
            GTEST_SKIP() << "no EGL without a surface";
        }
        spy_.context = &context_;
        current = &spy_;
    }
    void TearDown() override { current = nullptr; }

    [[nodiscard]] description watched() {
        description d;
        d.get_proc_address = &find;
        d.debug_labels = true;
        d.hooks = hooks_.to_me();
        return d;
    }
    [[nodiscard]] int group_depth() const {
        GLint depth = 0;
        real<PFNGLGETINTEGERVPROC>("glGetIntegerv")(GL_DEBUG_GROUP_STACK_DEPTH, &depth);
        return depth;
    }
    [[nodiscard]] static gpu must(result<gpu> made) {
        EXPECT_TRUE(made) << made.error().message;
        return std::move(*made);
    }

    caller_context context_;
    spy spy_;
    hook_log hooks_;
};

TEST_F(opengl_embedding, all_that_is_made_has_a_name_and_every_pattern_a_group) {
    {
        gpu device = must(gpu::create(watched()));
        EXPECT_EQ(hooks_.count(log_level::info, "The opengl device is "), 1);
        const support::every_pattern<gpu> all(device);
        for (int twice = 0; twice < 2; ++twice) {
            ASSERT_TRUE(run(device, [&](auto& r) { all.record(r); }));
        }
        for (const auto& [what, name] : spy_.alive) {
            EXPECT_TRUE(name.starts_with("skybark ")) << what.first << ": " << name;
        }
        for (const GLenum kind : kinds) {
            EXPECT_GT(spy_.made[kind], 0) << kind;
        }
        EXPECT_GT(spy_.made[GL_SHADER], 0);
        EXPECT_GT(spy_.made[GL_PROGRAM], 0);
        const buffer named = *device.create_buffer(64);
        device.set_name(named, "leaves of the oak");
        EXPECT_EQ((spy_.alive[{GL_BUFFER, named.name()}]), "leaves of the oak");
        spy_.alive[{GL_BUFFER, named.name()}] = "skybark "; // for the check at its end
    }
    EXPECT_TRUE(spy_.alive.empty()) << "something that was not deleted";
    EXPECT_EQ(spy_.open, 0);
    EXPECT_EQ(spy_.deepest, 1);
    EXPECT_EQ(group_depth(), 1) << "the one that is always there";
    EXPECT_EQ(spy_.groups, support::every_patterns_name());
    auto zones = support::every_patterns_name();
    zones.insert({"submit", "wait"});
    EXPECT_EQ(hooks_.zones, zones);
    EXPECT_EQ(hooks_.open, 0);
    EXPECT_GT(hooks_.count(log_level::debug, "one buffer of"), 0);
    EXPECT_GT(hooks_.count(log_level::debug, "one buffer to work in of"), 0);
    EXPECT_GT(hooks_.count(log_level::debug, "one volume of 480 bytes"), 0);
    EXPECT_EQ(hooks_.count(log_level::debug, "has compiled \"map_voxels probe_voxels\" in"), 1);
    EXPECT_EQ(hooks_.count(log_level::error, ""), 0);
}

TEST_F(opengl_embedding, results_are_those_of_a_device_that_nobody_watches) {
    std::vector<std::byte> expected;
    {
        gpu plain = must(gpu::create(context_.describe()));
        expected = support::run_every_pattern(plain);
    }
    EXPECT_TRUE(spy_.alive.empty());
    gpu device = must(gpu::create(watched()));
    EXPECT_EQ(support::run_every_pattern(device), expected);
}

TEST_F(opengl_embedding, without_labels_nothing_is_named) {
    auto description = watched();
    description.debug_labels = spy_.expects_names = false;
    gpu device = must(gpu::create(description));
    const support::every_pattern<gpu> all(device);
    ASSERT_TRUE(run(device, [&](auto& r) { all.record(r); }));
    EXPECT_TRUE(spy_.groups.empty());
    for (const auto& [what, name] : spy_.alive) {
        EXPECT_EQ(name, "");
    }
}

TEST_F(opengl_embedding, a_rejected_program_is_told_and_groups_stay_balanced) {
    gpu device = must(gpu::create(watched()));
    const support::every_pattern<gpu> all(device);
    spy_.reject_shaders = true;
    const auto done = run(device, [&](auto& r) { all.record(r); });
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, error_code::shader_rejected);
    EXPECT_EQ(hooks_.count(log_level::error, "No program \"map probe_map\""), 1);
    EXPECT_EQ(spy_.open, 0);
    EXPECT_EQ(hooks_.open, 0);
    EXPECT_EQ(group_depth(), 1);
    spy_.reject_shaders = false;
    EXPECT_TRUE(run(device, [&](auto& r) { all.record(r); }));
}

TEST_F(opengl_embedding, a_lost_context_is_told_once) {
    {
        gpu device = must(gpu::create(watched()));
        spy_.lose_context = true;
        for (int twice = 0; twice < 2; ++twice) {
            const auto refused = device.create_buffer(64);
            ASSERT_FALSE(refused);
            EXPECT_EQ(refused.error().code, error_code::device_lost);
        }
        EXPECT_EQ(hooks_.count(log_level::error, "is lost"), 1);
    }
    EXPECT_EQ(spy_.open, 0);
}

TEST_F(opengl_embedding, what_is_wrapped_stays_the_callers) {
    GLuint buffer_name = 0;
    GLuint flat = 0;
    GLuint deep = 0;
    real<PFNGLCREATEBUFFERSPROC>("glCreateBuffers")(1, &buffer_name);
    real<PFNGLNAMEDBUFFERSTORAGEPROC>("glNamedBufferStorage")(buffer_name, 64, nullptr, 0);
    const auto create_texture = real<PFNGLCREATETEXTURESPROC>("glCreateTextures");
    create_texture(GL_TEXTURE_2D, 1, &flat);
    create_texture(GL_TEXTURE_3D, 1, &deep);
    {
        gpu device = must(gpu::create(watched()));
        const buffer words = device.wrap_buffer(buffer_name, 64);
        const buffer total = *device.create_buffer(16);
        const image picture = device.wrap_image(flat, {4, 4, image_format::rgba8});
        const volume sums = device.wrap_volume(deep, {4, 4, 4, volume_format::int32});
        ASSERT_TRUE(run(device, [&](auto& r) { r.scan(view<gpu>(words), view<gpu>(total)); }));
    }
    // A deletion or a name would have been a failure in the functions in front as well.
    EXPECT_TRUE(real<PFNGLISBUFFERPROC>("glIsBuffer")(buffer_name));
    EXPECT_TRUE(real<PFNGLISTEXTUREPROC>("glIsTexture")(flat));
    EXPECT_TRUE(real<PFNGLISTEXTUREPROC>("glIsTexture")(deep));
}

// A pop must not take one of the caller's groups away where there was no room for ours.
TEST_F(opengl_embedding, a_full_stack_of_groups_is_left_alone) {
    gpu device = must(gpu::create(watched()));
    const support::every_pattern<gpu> all(device);
    GLint most = 0;
    real<PFNGLGETINTEGERVPROC>("glGetIntegerv")(GL_MAX_DEBUG_GROUP_STACK_DEPTH, &most);
    const auto push = real<PFNGLPUSHDEBUGGROUPPROC>("glPushDebugGroup");
    while (group_depth() < most) {
        push(GL_DEBUG_SOURCE_APPLICATION, 0, -1, "the caller's");
    }
    ASSERT_TRUE(run(device, [&](auto& r) { all.record(r); }));
    EXPECT_EQ(group_depth(), most);
    EXPECT_TRUE(spy_.groups.empty());
    while (group_depth() > 1) {
        real<PFNGLPOPDEBUGGROUPPROC>("glPopDebugGroup")();
    }
}

} // namespace
} // namespace skybark::opengl::tests
