#!/usr/bin/env python3
"""Builds and runs a fresh project that takes Skybark in one way, from the snippets of docs/including.md.

    install.py WAY --cmake CMAKE --generator GENERATOR --compiler CXX --version VERSION

WAY: find_package, pkg_config, fetch_content, add_subdirectory, bare_include, single_header or
debian_package. The folders of the fresh project, and of what it takes, have spaces in their names.
Exits with 77 where a tool is missing.
"""

import argparse
import gzip
import os
import re
import shlex
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SHADERS = "Skybark's functions in your shaders" # the heading
SAYS = "A trunk of 60 triangles.\n" # three gaps of 2 · 8, and two caps of 6
WARNINGS = ["-Wall", "-Wextra", "-Werror"]
# What the library is made of; an archive of a release holds more.
SOURCES = ("CMakeLists.txt", "LICENSE", "README.md", "backends", "cmake", "include", "packaging")


def fail(*sentences):
    print(*sentences, sep="\n")
    sys.exit(1)


def skip(sentence):
    print("Skipped:", sentence)
    sys.exit(77)


def snippets(language, heading=""):
    """The blocks of a language under a heading of docs/including.md; without one, before the first."""
    text = (ROOT / "docs/including.md").read_text("utf-8")
    parts = dict(re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", "## \n" + text, re.M | re.S))
    return re.findall(rf"```{language}\n(.*?)```", parts[heading], re.S)


class Project:
    """A fresh folder with main.cpp in it, and this repository as `skybark`. Its PATH begins with the
    cmake and the c++ that were asked for; its home is empty."""

    def __init__(self, options, folder):
        self.options = options
        self.folder = folder / "my meadow"
        self.folder.mkdir()
        self.home = folder / "home"
        self.write("main.cpp", snippets("cpp")[0])
        (self.folder / "skybark").symlink_to(ROOT)
        tools = folder / "tools"
        tools.mkdir()
        compiler = tools / "c++"
        compiler.write_text(f'#!/bin/sh\nexec {shlex.quote(options.compiler)} -O0 "$@"\n')
        compiler.chmod(0o755)
        cmake = tools / "cmake"
        cmake.symlink_to(shutil.which(options.cmake))
        self.environment = dict(os.environ, PATH=f"{tools}:{os.environ['PATH']}", HOME=str(self.home),
                                CMAKE_GENERATOR=options.generator, CXX=options.compiler,
                                CXXFLAGS="-O0", CMAKE_BUILD_PARALLEL_LEVEL="1", LC_ALL="C.UTF-8")
        for name in ("CMAKE_PREFIX_PATH", "PKG_CONFIG_PATH", "CPLUS_INCLUDE_PATH", "DESTDIR"):
            self.environment.pop(name, None)

    def write(self, name, text):
        (self.folder / name).write_text(text, "utf-8")

    def run(self, command, succeeds=True, **variables):
        """Runs a command line of sh, or a list, in the project; gives what it prints."""
        done = subprocess.run(command, shell=isinstance(command, str), cwd=self.folder, text=True,
                              env={**self.environment, **variables}, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT)
        if (done.returncode == 0) != succeeds:
            fail(done.stdout, f"This {'failed' if succeeds else 'should have failed'}: {command}")
        return done.stdout

    def expect(self, program="build/meadow", says=SAYS):
        said = self.run([str(self.folder / program)])
        if said != says:
            fail(f"{program} says {said!r} and should say {says!r}.")

    def configure(self, lists, *arguments, build="build", succeeds=True):
        self.write("CMakeLists.txt", lists)
        return self.run(["cmake", "-S", ".", "-B", build, *arguments], succeeds)

    def build_and_run(self, lists, *arguments):
        self.configure(lists, *arguments)
        self.run(["cmake", "--build", "build"])
        self.expect()


def install(project):
    """Installs into the home, moves that, and gives where it is: nothing may remember where it was."""
    first = project.home.with_name("first home")
    project.run(snippets("sh", "find_package")[0], HOME=str(first))
    first.rename(project.home)
    folder = str(project.folder.parent)
    for path in (project.home / ".local").rglob("*"):
        if path.is_file() and any(name.encode() in path.read_bytes() for name in (str(ROOT), folder)):
            fail(f"{path} names a folder of the build.")
    return project.home / ".local"


# ---- The ways --------------------------------------------------------------------------------------


def add_shader(project, lists):
    """The lists with the shader of docs/including.md; without, where there is nothing to compile it."""
    project.write("ground.frag", snippets("glsl", SHADERS)[0])
    if not shutil.which("glslangValidator"):
        print("glslangValidator isn't installed: no shader is compiled.")
        return lists
    return lists + snippets("cmake", SHADERS)[0]


def find_package(project, folder):
    here = f"-DCMAKE_PREFIX_PATH={install(project)}"
    lists = snippets("cmake", "find_package")[0]
    project.write("CMakeLists.txt", add_shader(project, lists))
    project.run(snippets("sh", "find_package")[1])
    project.expect()
    check_shader(project, "build/ground.spv")

    # Refusals are sentences.
    def refuse(expected, version="0.1", components="cpu", *arguments):
        text = lists.replace("0.1", version).replace("COMPONENTS cpu", f"COMPONENTS {components}")
        said = " ".join(project.configure(text, here, *arguments, build="refused", succeeds=False).split())
        shutil.rmtree(project.folder / "refused")
        if expected not in said:
            fail(said, f'It should have said "{expected}".')

    refuse('skybark has no component "nonsense"; it has cpu, opengl, vulkan, conformance.', "0.1", "cpu nonsense")
    refuse("requested version", "0.0")
    refuse("requested version", "0.2")
    refuse("requested version", "1.0")
    nowhere = ["-DCMAKE_DISABLE_FIND_PACKAGE_Vulkan=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_VulkanHeaders=ON"]
    refuse("skybark's component vulkan needs the headers of Vulkan 1.3", "0.1", "vulkan", *nowhere)

    # Optional components may be missing, and no components are all that can be.
    optional = "CONFIG REQUIRED COMPONENTS cpu OPTIONAL_COMPONENTS nonsense vulkan"
    targets = """
if(skybark_nonsense_FOUND OR skybark_vulkan_FOUND OR NOT TARGET skybark::cpu)
    message(FATAL_ERROR "Wrong about optional components")
endif()
"""
    project.configure(lists.replace("CONFIG REQUIRED COMPONENTS cpu", optional) + targets, here, *nowhere,
                      build="optional")
    targets = "".join(f"get_target_property(links skybark::{name} INTERFACE_LINK_LIBRARIES)\n"
                      for name in ("skybark", "cpu", "opengl", "vulkan", "conformance"))
    project.configure(lists.replace(" COMPONENTS cpu", "") + targets, here, build="all")


def pkg_config(project, folder):
    if not shutil.which("pkg-config"):
        skip("pkg-config isn't installed.")
    prefix = install(project)
    command, with_spaces = snippets("sh", "pkg-config")
    with tempfile.TemporaryDirectory(prefix="skybark-") as plain: # for the snippet as it stands
        shutil.copytree(prefix, f"{plain}/prefix")
        path = {"PKG_CONFIG_PATH": f"{plain}/prefix/share/pkgconfig"}
        project.run(command, **path)
        if project.run("pkg-config --modversion skybark", **path).strip() != project.options.version:
            fail("pkg-config knows another version.")
        # A shader of the caller's, here and without an installation.
        if add_shader(project, ""):
            for shader_command in snippets("sh", SHADERS)[0].splitlines():
                project.run(shader_command, **path)
                check_shader(project, "ground.spv")
                (project.folder / "ground.spv").unlink()
    project.expect("meadow")

    # The one for paths with spaces, with less to compile.
    project.write("main.cpp", '#include <skybark/core/result.hpp>\nint main() {}\n')
    project.run(with_spaces, PKG_CONFIG_PATH=str(prefix / "share/pkgconfig"))
    project.expect("meadow", "")


def fetch_content(project, folder):
    name = f"skybark-{project.options.version}"
    archive = folder / f"an archive of {name}.tar.gz"
    with tarfile.open(archive, "w:gz", compresslevel=1) as tar:
        for source in SOURCES:
            tar.add(ROOT / source, f"{name}/{source}")
    lists = add_shader(project, snippets("cmake", "FetchContent")[0])
    project.build_and_run(lists, f"-DSKYBARK_ARCHIVE=file://{archive}",
                          "-DCMAKE_POLICY_DEFAULT_CMP0135=NEW")
    check_shader(project, "build/ground.spv")


def add_subdirectory(project, folder):
    (project.folder / "third_party").mkdir()
    (project.folder / "skybark").rename(project.folder / "third_party/skybark")
    project.build_and_run(add_shader(project, snippets("cmake", "add_subdirectory")[0]))
    check_shader(project, "build/ground.spv")
    targets = project.run(["cmake", "--build", "build", "--target", "help"])
    if re.search(r"skybark_tool|test_|skybark_benchmarks|single_headers", targets):
        fail(targets, "As a part of another project it builds programs of its own.")
    project.run(["cmake", "--install", "build", "--prefix", str(project.home)])
    if project.home.exists():
        fail("As a part of another project it installs itself.")


def bare_include(project, folder):
    project.run(snippets("sh", "Bare includes")[0])
    project.expect("meadow")


def single_header(project, folder):
    snippet, by_cmake = snippets("sh", "Single headers")
    project.run(snippets("sh", "find_package")[0])
    project.run(by_cmake)
    for backend in ("cpu", "opengl", "vulkan"):
        project.run(snippet.replace("cpu", backend))
        header = project.folder / f"skybark_{backend}.hpp"
        text = header.read_text("utf-8")
        if text != (project.home / f".local/include/{header.name}").read_text("utf-8"):
            fail(f"{header.name} depends on where it is made.")
        if str(ROOT) in text or re.search(r"#\s*include\s*<skybark/", text):
            fail(f"{header.name} names files of this repository.")
    (project.folder / "skybark").unlink() # from here on they stand alone

    # Two of them a file, in two orders, and the cpu backend's in both.
    program = re.sub(r"(#include <skybark/.*>\n)+",
                     '#include "skybark_opengl.hpp"\n#include "skybark_cpu.hpp"\n', snippets("cpp")[0])
    project.write("main.cpp", program)
    project.write("second.cpp", """#include "skybark_vulkan.hpp"
#include "skybark_cpu.hpp"
bool second() {
    return skybark::cpu::device().create_buffer(16) && skybark::vulkan::device::create({}) &&
           !skybark::glsl::cloud_shadow.empty();
}
""")
    for name in ("main", "second"):
        project.run(["c++", "-std=c++20", *WARNINGS, "-c", f"{name}.cpp"])
    project.run("c++ main.o second.o -pthread -ldl -o meadow")
    project.expect("meadow")


def check_shader(project, name):
    """SPIR-V begins with its number."""
    path = project.folder / name
    if shutil.which("glslangValidator") and path.read_bytes()[:4] != bytes([3, 2, 35, 7]):
        fail(f"{name} is no SPIR-V.")


# ---- The Debian package ----------------------------------------------------------------------------

PACKAGE = "libskybark-dev"


def installed_files():
    """What of the package lies in /usr, but for documents, which a system may leave out."""
    places = ["include/skybark", "share/cmake/skybark", "share/pkgconfig/skybark.pc"]
    return [str(Path("/usr") / place) for place in places if (Path("/usr") / place).exists()]


def check_package(project, package):
    version = project.options.version
    fields = project.run(["dpkg-deb", "-f", package])
    for field in (f"Package: {PACKAGE}", f"Version: {version}", "Architecture: all",
                  "Depends: libglm-dev, libexpected-dev", "Section: libdevel"):
        if field not in fields.splitlines():
            fail(fields, f'The package has no field "{field}".')
    listed = project.run(["dpkg-deb", "-c", package]).splitlines()
    files = {line.split()[-1][1:]: line.split()[0] for line in listed if not line.endswith("/")}
    expected = {"/usr/include/" + path.relative_to(ROOT / root).as_posix()
                for root in ("include", "backends")
                for suffix in ("hpp", "glsl") for path in (ROOT / root).rglob(f"*.{suffix}")}
    expected |= {f"/usr/share/cmake/skybark/skybark-{name}.cmake"
                 for name in ("config", "config-version", "targets", "cpu", "opengl", "vulkan", "conformance")}
    expected |= {"/usr/share/pkgconfig/skybark.pc", f"/usr/share/doc/{PACKAGE}/copyright",
                 f"/usr/share/doc/{PACKAGE}/changelog.gz"}
    if set(files) != expected:
        fail(*sorted(set(files) ^ expected), "These are in the package or expected there, not both.")
    wrong = [name for name, mode in files.items() if mode != "-rw-r--r--"]
    if wrong or not all("root/root" in line for line in listed):
        fail(*wrong, "Owners or permissions of the package's files are wrong.")


def debian_package(project, folder):
    for tool in ("cpack", "dpkg-deb", "gzip"):
        if not shutil.which(tool):
            skip(f"{tool} isn't installed.")
    project.run(snippets("sh", "A Debian package")[0])
    package = str(project.folder / f"headers/{PACKAGE}_{project.options.version}_all.deb")
    check_package(project, package)
    unpacked = folder / "unpacked"
    project.run(["dpkg-deb", "-x", package, str(unpacked)])
    changelog = gzip.decompress((unpacked / f"usr/share/doc/{PACKAGE}/changelog.gz").read_bytes()).decode()
    if not changelog.startswith(f"skybark ({project.options.version}) "):
        fail("packaging/debian/changelog begins with another version.")

    lists = add_shader(project, snippets("cmake", "find_package")[0])
    if os.geteuid() != 0 or installed_files():
        print(f"Unpacked only: {'it is installed' if installed_files() else 'only root can install it'}.")
        project.build_and_run(lists, f"-DCMAKE_PREFIX_PATH={unpacked / 'usr'}")
        check_shader(project, "build/ground.spv")
        return
    try:
        project.run(["dpkg", "-i", package], DEBIAN_FRONTEND="noninteractive")
        project.build_and_run(lists)
        if "skybark_DIR:PATH=/usr/share/cmake/skybark" not in (
                project.folder / "build/CMakeCache.txt").read_text().splitlines():
            fail("The program was built with another Skybark.")
    finally:
        removed = project.run(["dpkg", "--purge", PACKAGE], DEBIAN_FRONTEND="noninteractive")
    if installed_files():
        fail(removed, *installed_files(), "These remain after the package has been removed.")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    ways = (find_package, pkg_config, fetch_content, add_subdirectory, bare_include, single_header,
            debian_package)
    parser.add_argument("way", choices=[way.__name__ for way in ways])
    for name in ("cmake", "generator", "compiler", "version"):
        parser.add_argument(f"--{name}", required=True)
    options = parser.parse_args()
    options.compiler = shutil.which(options.compiler) or skip(f"{options.compiler} isn't installed.")
    with tempfile.TemporaryDirectory(prefix="skybark install ") as folder:
        globals()[options.way](Project(options, Path(folder)), Path(folder))


main()
