// A cloud's shadow in a shader of your own: a program of OpenGL's draws its ground with its own
// shaders, which ask Skybark's volume how much sunlight is left; for two suns, side by side.
//
//     example_09_cloud_shadow_in_your_shader [PICTURE.png]
//
// What is Skybark's is in `main`, and one string in the fragment shader; the rest is what such a
// program has anyway, and the check: the middle of a shadow lies where the sun throws it.

#include <skybark/glsl/cloud_shadow.hpp>
#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/opengl.hpp>
#include <skybark/skybark.hpp>

#include <GL/glcorearb.h>
#include <io/write_png.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <string>
#include <vector>

namespace {

namespace clouds = skybark::clouds;
using backend = skybark::opengl::device;

constexpr int no_such_backend = 3;
constexpr int side = 256;      // pixels of the ground of each sun
constexpr float extent = 3000; // m, from the middle of the ground to its edges

[[noreturn]] void stop(int status, const std::string& why) {
    std::fprintf(stderr, "%s\n", why.c_str());
    std::exit(status);
}
template <class T>
T value_of(skybark::result<T> made) {
    if (!made) {
        stop(1, made.error().message);
    }
    return std::move(*made);
}

// ---- The program's shaders ----------------------------------------------------------------------

constexpr std::string_view version = "#version 450\n";

/// The ground from above: x to the right, z down the picture.
constexpr std::string_view vertex_text = R"glsl(
layout(location = 0) uniform float extent;
layout(location = 0) out vec3 place;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    place = vec3(corner.x, 0.0, -corner.y) * extent;
    gl_Position = vec4(corner, 0.0, 1.0);
}
)glsl";

/// Between #version and this stands skybark::glsl::cloud_shadow: light_grid and cloud_sunlight.
constexpr std::string_view fragment_text = R"glsl(
layout(location = 0) in vec3 place; // m, in the world
layout(location = 0) out vec4 color;
layout(binding = 0) uniform sampler3D attenuation;
layout(std140, binding = 0) uniform cloud_block { light_grid grid; };
void main() {
    float sun = cloud_sunlight(attenuation, grid, place); // 1 beside the shadow
    bool dark = (int(floor(place.x / 500.0)) + int(floor(place.z / 500.0))) % 2 == 0;
    vec3 albedo = dark ? vec3(0.20, 0.30, 0.10) : vec3(0.24, 0.34, 0.12);
    vec3 sky = vec3(0.4, 0.5, 0.7);
    color = vec4(albedo * (sky + 2.0 * sun), sun);
}
)glsl";

// ---- The program's OpenGL -----------------------------------------------------------------------

/// OpenGL's functions, by their names.
struct functions {
    const skybark::opengl::headless* context;

    template <class Function, class... Arguments>
    auto call(const char* name, Arguments... arguments) const {
        return reinterpret_cast<Function>(context->find(name))(arguments...);
    }
};

class painter {
  public:
    explicit painter(const skybark::opengl::headless& context) : gl_{&context} {
        program_ = make_program();
        // Volumes are sampled with whatever sampler is yours: linear, clamped to the edges.
        gl_.call<PFNGLCREATESAMPLERSPROC>("glCreateSamplers", 1, &sampler_);
        for (const GLenum which : {GLenum{GL_TEXTURE_MIN_FILTER}, GLenum{GL_TEXTURE_MAG_FILTER}}) {
            gl_.call<PFNGLSAMPLERPARAMETERIPROC>("glSamplerParameteri", sampler_, which, GL_LINEAR);
        }
        for (const GLenum which :
             {GLenum{GL_TEXTURE_WRAP_S}, GLenum{GL_TEXTURE_WRAP_T}, GLenum{GL_TEXTURE_WRAP_R}}) {
            gl_.call<PFNGLSAMPLERPARAMETERIPROC>("glSamplerParameteri", sampler_, which,
                                                 GL_CLAMP_TO_EDGE);
        }
        gl_.call<PFNGLCREATEBUFFERSPROC>("glCreateBuffers", 1, &block_);
        gl_.call<PFNGLNAMEDBUFFERSTORAGEPROC>("glNamedBufferStorage", block_,
                                              GLsizeiptr{sizeof(skybark::light_grid)}, nullptr,
                                              GLbitfield{GL_DYNAMIC_STORAGE_BIT});
        gl_.call<PFNGLCREATETEXTURESPROC>("glCreateTextures", GLenum{GL_TEXTURE_2D}, 1, &picture_);
        gl_.call<PFNGLTEXTURESTORAGE2DPROC>("glTextureStorage2D", picture_, 1, GLenum{GL_RGBA32F},
                                            2 * side, side);
        gl_.call<PFNGLCREATEFRAMEBUFFERSPROC>("glCreateFramebuffers", 1, &framebuffer_);
        gl_.call<PFNGLNAMEDFRAMEBUFFERTEXTUREPROC>("glNamedFramebufferTexture", framebuffer_,
                                                   GLenum{GL_COLOR_ATTACHMENT0}, picture_, 0);
        gl_.call<PFNGLCREATEVERTEXARRAYSPROC>("glCreateVertexArrays", 1, &no_vertices_);
    }
    painter(const painter&) = delete;
    painter& operator=(const painter&) = delete;
    ~painter() {
        gl_.call<PFNGLDELETEPROGRAMPROC>("glDeleteProgram", program_);
        gl_.call<PFNGLDELETESAMPLERSPROC>("glDeleteSamplers", 1, &sampler_);
        gl_.call<PFNGLDELETEBUFFERSPROC>("glDeleteBuffers", 1, &block_);
        gl_.call<PFNGLDELETETEXTURESPROC>("glDeleteTextures", 1, &picture_);
        gl_.call<PFNGLDELETEFRAMEBUFFERSPROC>("glDeleteFramebuffers", 1, &framebuffer_);
        gl_.call<PFNGLDELETEVERTEXARRAYSPROC>("glDeleteVertexArrays", 1, &no_vertices_);
    }

    /// The ground into half of the picture. `volume` is the name of a texture of Skybark's; its
    /// writing has been waited for, so this is drawn like anything else.
    void draw_ground(int half, GLuint volume, const skybark::light_grid& grid) const {
        gl_.call<PFNGLNAMEDBUFFERSUBDATAPROC>("glNamedBufferSubData", block_, GLintptr{0},
                                              GLsizeiptr{sizeof grid}, &grid);
        gl_.call<PFNGLBINDBUFFERBASEPROC>("glBindBufferBase", GLenum{GL_UNIFORM_BUFFER}, GLuint{0},
                                          block_);
        gl_.call<PFNGLBINDTEXTUREUNITPROC>("glBindTextureUnit", GLuint{0}, volume);
        gl_.call<PFNGLBINDSAMPLERPROC>("glBindSampler", GLuint{0}, sampler_);
        gl_.call<PFNGLBINDFRAMEBUFFERPROC>("glBindFramebuffer", GLenum{GL_FRAMEBUFFER},
                                           framebuffer_);
        gl_.call<PFNGLVIEWPORTPROC>("glViewport", half * side, 0, side, side);
        gl_.call<PFNGLUSEPROGRAMPROC>("glUseProgram", program_);
        gl_.call<PFNGLUNIFORM1FPROC>("glUniform1f", 0, extent);
        gl_.call<PFNGLBINDVERTEXARRAYPROC>("glBindVertexArray", no_vertices_);
        gl_.call<PFNGLDRAWARRAYSPROC>("glDrawArrays", GLenum{GL_TRIANGLE_STRIP}, 0, 4);
    }

    /// Rows from the top; w is the sunlight that the shader found.
    [[nodiscard]] std::vector<glm::vec4> pixels() const {
        std::vector<glm::vec4> rows(2 * side * side);
        gl_.call<PFNGLBINDFRAMEBUFFERPROC>("glBindFramebuffer", GLenum{GL_FRAMEBUFFER},
                                           framebuffer_);
        for (int y = 0; y < side; ++y) { // OpenGL's begin at the bottom
            gl_.call<PFNGLREADPIXELSPROC>("glReadPixels", 0, side - 1 - y, 2 * side, 1,
                                          GLenum{GL_RGBA}, GLenum{GL_FLOAT},
                                          &rows[static_cast<std::size_t>(2 * side * y)]);
        }
        return rows;
    }

  private:
    [[nodiscard]] GLuint make_shader(GLenum stage,
                                     std::initializer_list<std::string_view> texts) const {
        std::string whole;
        for (const std::string_view text : texts) {
            whole += text;
        }
        const char* const begin = whole.c_str();
        const GLuint shader = gl_.call<PFNGLCREATESHADERPROC>("glCreateShader", stage);
        gl_.call<PFNGLSHADERSOURCEPROC>("glShaderSource", shader, 1, &begin, nullptr);
        gl_.call<PFNGLCOMPILESHADERPROC>("glCompileShader", shader);
        return shader;
    }

    [[nodiscard]] GLuint make_program() const {
        const GLuint program = gl_.call<PFNGLCREATEPROGRAMPROC>("glCreateProgram");
        for (const GLuint shader :
             {make_shader(GL_VERTEX_SHADER, {version, vertex_text}),
              make_shader(GL_FRAGMENT_SHADER,
                          {version, skybark::glsl::cloud_shadow, fragment_text})}) {
            gl_.call<PFNGLATTACHSHADERPROC>("glAttachShader", program, shader);
            gl_.call<PFNGLDELETESHADERPROC>("glDeleteShader", shader);
        }
        gl_.call<PFNGLLINKPROGRAMPROC>("glLinkProgram", program);
        GLint linked = 0;
        gl_.call<PFNGLGETPROGRAMIVPROC>("glGetProgramiv", program, GLenum{GL_LINK_STATUS}, &linked);
        if (linked != GL_TRUE) {
            std::string why(4096, '\0');
            gl_.call<PFNGLGETPROGRAMINFOLOGPROC>("glGetProgramInfoLog", program, 4096, nullptr,
                                                 why.data());
            stop(1, why.c_str());
        }
        return program;
    }

    functions gl_;
    GLuint program_ = 0;
    GLuint sampler_ = 0;
    GLuint block_ = 0;
    GLuint picture_ = 0;
    GLuint framebuffer_ = 0;
    GLuint no_vertices_ = 0;
};

// ---- The check ----------------------------------------------------------------------------------

/// Where the middle of what is taken out of the light is thrown to: each particle takes out as
/// much as its optical depth times its area.
glm::dvec2 expected_middle(const std::vector<skybark::cloud_particle>& cloud, glm::vec3 to_sun) {
    glm::dvec2 sum(0);
    double weights = 0;
    for (const skybark::cloud_particle& p : cloud) {
        const glm::dvec3 at(p.position);
        const glm::dvec3 sun(to_sun);
        const double weight = double(p.optical_depth) * double(p.radius) * double(p.radius);
        sum += weight * glm::dvec2(at.x - sun.x * at.y / sun.y, at.z - sun.z * at.y / sun.y);
        weights += weight;
    }
    return sum / weights;
}

/// Where it lies in half of the picture: the middle of −ln of the light.
glm::dvec2 found_middle(const std::vector<glm::vec4>& pixels, int half) {
    glm::dvec2 sum(0);
    double weights = 0;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const double light =
                double(pixels[static_cast<std::size_t>((2 * y + half) * side + x)].w);
            const double weight = -std::log(light);
            const double pixel = 2.0 * double(extent) / side;
            sum += weight * (pixel * (glm::dvec2(x, y) + 0.5) - double(extent));
            weights += weight;
        }
    }
    return sum / weights;
}

void write(const char* path, const std::vector<glm::vec4>& pixels) {
    std::vector<std::uint8_t> bytes;
    for (const glm::vec4& p : pixels) {
        for (int c = 0; c < 3; ++c) {
            bytes.push_back(static_cast<std::uint8_t>(255 * std::sqrt(std::min(p[c], 1.0f))));
        }
        bytes.push_back(255);
    }
    const auto written = skybark::io::write_png(path, bytes, 2 * side, side);
    if (!written) {
        stop(1, written.error().message);
    }
}

} // namespace

int main(int argc, char** argv) {
    // The context could be yours as well: see 05_caller_opengl_context.cpp.
    auto context = skybark::opengl::headless::create();
    if (!context) {
        stop(no_such_backend, context.error().message);
    }
    backend& device = context->device();

    clouds::cumulus_options shape;
    shape.extinction = 0.01f; // 1/m: a thin one, so that its shadow is nowhere black
    const std::vector<skybark::cloud_particle> cloud = clouds::cumulus_cloud(shape);
    const auto particles = value_of(skybark::make_buffer<backend, skybark::cloud_particle>(
        device, std::span<const skybark::cloud_particle>(cloud)));
    const glm::uvec3 voxels(96, 64, 96);
    auto light = value_of(clouds::attenuation_volume<backend>::create(device, voxels));

    const painter mine(*context);
    const glm::vec3 suns[] = {{0.2f, 0.95f, 0.1f}, {-0.75f, 0.6f, 0.3f}};
    for (int i = 0; i < 2; ++i) {
        // Each frame: where the light's grid lies, the volume anew, and the program's own drawing.
        const clouds::light_box box = value_of(clouds::fit_light_box(cloud, suns[i], voxels));
        const auto relit = skybark::run(device, [&](auto& recorder) {
            light.relight(recorder, skybark::view<backend>(particles),
                          static_cast<std::uint32_t>(cloud.size()), box);
        });
        if (!relit) {
            stop(1, relit.error().message);
        }
        mine.draw_ground(i, light.volume().name(), box.grid);
    }

    const std::vector<glm::vec4> pixels = mine.pixels();
    if (argc > 1) {
        write(argv[1], pixels);
    }
    bool right = true;
    for (int i = 0; i < 2; ++i) {
        const glm::dvec2 found = found_middle(pixels, i);
        const double off = glm::length(found - expected_middle(cloud, suns[i]));
        right = right && off < 5; // m; a fifth of a pixel
        std::printf("The middle of shadow %d lies at (%.0f, %.0f) m on the ground, %.2f m from "
                    "where the sun throws it\n",
                    i + 1, found.x, found.y, off);
    }
    return right ? 0 : 1;
}
