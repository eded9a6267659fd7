// A caller's own program of OpenGL, in his own context, asks for a cloud's light and for gathered
// light: skybark::glsl's strings and the names of the volumes' textures are all that it needs.

#include "caller.hpp"
#include "support/caller_light.hpp"

#include <skybark/glsl/cloud_scattering.hpp>
#include <skybark/glsl/cloud_shadow.hpp>
#include <skybark/glsl/irradiance_volume.hpp>
#include <skybark/glsl/phase.hpp>

#include <fstream>

namespace skybark::opengl::tests {
namespace {

using support::caller_found;
using support::caller_place;

/// tests/support/caller_light.comp without its includes.
std::string own_text() {
    std::ifstream file(SKYBARK_CALLER_LIGHT);
    EXPECT_TRUE(file) << SKYBARK_CALLER_LIGHT;
    std::string text;
    for (std::string line; std::getline(file, line);) {
        text += line.starts_with('#') ? std::string() : line + "\n";
    }
    return text;
}

class caller_shader_test : public testing::Test {
  protected:
    void SetUp() override {
        if (!caller.current()) {
            ASSERT_FALSE(required()) << "no EGL context";
            GTEST_SKIP() << "no EGL context";
        }
        auto created = gpu::create(caller.describe());
        ASSERT_TRUE(created) << created.error().message;
        device.emplace(std::move(*created));
    }

    template <class Function, class... Arguments>
    auto gl(const char* name, Arguments... arguments) const {
        return reinterpret_cast<Function>(caller.find(name))(arguments...);
    }

    /// The program of these texts, one after another.
    [[nodiscard]] GLuint program(std::initializer_list<std::string_view> texts) const {
        std::vector<const char*> begins;
        std::vector<GLint> lengths;
        for (const std::string_view text : texts) {
            begins.push_back(text.data());
            lengths.push_back(static_cast<GLint>(text.size()));
        }
        const GLuint shader =
            gl<PFNGLCREATESHADERPROC>("glCreateShader", GLenum{GL_COMPUTE_SHADER});
        gl<PFNGLSHADERSOURCEPROC>("glShaderSource", shader, static_cast<GLsizei>(begins.size()),
                                  begins.data(), lengths.data());
        gl<PFNGLCOMPILESHADERPROC>("glCompileShader", shader);
        const GLuint linked = gl<PFNGLCREATEPROGRAMPROC>("glCreateProgram");
        gl<PFNGLATTACHSHADERPROC>("glAttachShader", linked, shader);
        gl<PFNGLLINKPROGRAMPROC>("glLinkProgram", linked);
        gl<PFNGLDELETESHADERPROC>("glDeleteShader", shader);
        GLint done = 0;
        gl<PFNGLGETPROGRAMIVPROC>("glGetProgramiv", linked, GLenum{GL_LINK_STATUS}, &done);
        std::vector<char> said(4096);
        gl<PFNGLGETPROGRAMINFOLOGPROC>("glGetProgramInfoLog", linked, 4096, nullptr, said.data());
        EXPECT_EQ(done, GL_TRUE) << said.data();
        return linked;
    }

    [[nodiscard]] GLuint buffer_of(const void* bytes, std::size_t size) const {
        GLuint name = 0;
        gl<PFNGLCREATEBUFFERSPROC>("glCreateBuffers", 1, &name);
        gl<PFNGLNAMEDBUFFERSTORAGEPROC>("glNamedBufferStorage", name, static_cast<GLsizeiptr>(size),
                                        bytes, GLbitfield{0});
        return name;
    }

    /// What the program finds at the light's places.
    [[nodiscard]] std::vector<caller_found> ask(GLuint with,
                                                const support::caller_light<gpu>& light,
                                                const support::caller_moment& of) const {
        const auto places = light.places(of);
        const auto lights = light.lights(of);
        std::vector<caller_found> found(places.size());
        const std::size_t bytes = found.size() * sizeof(caller_found);
        const std::array<GLuint, 3> buffers{
            buffer_of(&lights, sizeof lights),
            buffer_of(places.data(), places.size() * sizeof(caller_place)),
            buffer_of(nullptr, bytes)};
        const auto bind = [&](GLenum target, GLuint at, GLuint name) {
            gl<PFNGLBINDBUFFERBASEPROC>("glBindBufferBase", target, at, name);
        };
        bind(GL_UNIFORM_BUFFER, 0, buffers[0]);
        bind(GL_SHADER_STORAGE_BUFFER, 4, buffers[1]);
        bind(GL_SHADER_STORAGE_BUFFER, 5, buffers[2]);
        const std::array<const volume*, 3> volumes{&light.attenuation(), &light.fluence(),
                                                   &light.gathered()};
        for (GLuint i = 0; i < 3; ++i) {
            gl<PFNGLBINDTEXTUREUNITPROC>("glBindTextureUnit", i + 1, volumes[i]->name());
            gl<PFNGLBINDSAMPLERPROC>("glBindSampler", i + 1, sampler());
        }
        gl<PFNGLUSEPROGRAMPROC>("glUseProgram", with);
        gl<PFNGLDISPATCHCOMPUTEPROC>("glDispatchCompute",
                                     static_cast<GLuint>((places.size() + 63) / 64), GLuint{1},
                                     GLuint{1});
        gl<PFNGLMEMORYBARRIERPROC>("glMemoryBarrier", GLbitfield{GL_BUFFER_UPDATE_BARRIER_BIT});
        gl<PFNGLGETNAMEDBUFFERSUBDATAPROC>("glGetNamedBufferSubData", buffers[2], GLintptr{0},
                                           static_cast<GLsizeiptr>(bytes), found.data());
        gl<PFNGLDELETEBUFFERSPROC>("glDeleteBuffers", 3, buffers.data());
        return found;
    }

    /// Linear, clamped to the edges.
    [[nodiscard]] GLuint sampler() const {
        GLuint name = 0;
        gl<PFNGLCREATESAMPLERSPROC>("glCreateSamplers", 1, &name);
        const auto set = [&](GLenum what, GLint value) {
            gl<PFNGLSAMPLERPARAMETERIPROC>("glSamplerParameteri", name, what, value);
        };
        set(GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        set(GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        for (const GLenum side :
             {GLenum{GL_TEXTURE_WRAP_S}, GLenum{GL_TEXTURE_WRAP_T}, GLenum{GL_TEXTURE_WRAP_R}}) {
            set(side, GL_CLAMP_TO_EDGE);
        }
        return name;
    }

    caller_context caller;
    std::optional<gpu> device;
};

/// With nothing between a relighting and the caller's program but the program, for two suns.
TEST_F(caller_shader_test, finds_light_in_the_volumes) {
    const std::string own = own_text();
    const GLuint mine = program({"#version 450\n", glsl::cloud_shadow, glsl::irradiance_volume,
                                 glsl::cloud_scattering, glsl::phase, own});
    support::caller_light<gpu> light(*device);
    for (const glm::vec3 sun : {glm::vec3(0.3f, 0.9f, 0.2f), glm::vec3(-0.8f, 0.25f, 0.1f)}) {
        auto recorded = device->begin();
        ASSERT_TRUE(recorded) << recorded.error().message;
        const support::caller_moment now = light.relight(*recorded, sun);
        const std::vector<caller_found> found = ask(mine, light, now);
        const auto done = device->submit(*recorded);
        ASSERT_TRUE(done) << done.error().message;
        light.expect_right(found, now, light.fluence_cells());
    }
}

/// Parts that texts share are defined once, whichever comes first and however often.
TEST_F(caller_shader_test, holds_the_texts_in_any_order) {
    const std::string own = own_text();
    std::array<std::string_view, 4> texts{glsl::cloud_scattering, glsl::cloud_shadow,
                                          glsl::irradiance_volume, glsl::phase};
    std::sort(texts.begin(), texts.end());
    do {
        EXPECT_NE(
            program({"#version 430\n", texts[0], texts[1], texts[2], texts[3], texts[0], own}), 0u);
    } while (std::next_permutation(texts.begin(), texts.end()));
}

} // namespace
} // namespace skybark::opengl::tests
