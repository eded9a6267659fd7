# What the top level offers beyond installing: the single headers, and a Debian package.

# ---- cmake --build BUILD --target single_headers: BUILD/single/skybark_cpu.hpp, … ----------------

find_package(Python3 QUIET COMPONENTS Interpreter)
if(TARGET Python3::Interpreter)
    file(GLOB_RECURSE headers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/include/*.hpp"
         "${PROJECT_SOURCE_DIR}/backends/*.hpp")
    set(singles)
    foreach(backend cpu opengl vulkan)
        set(single "${PROJECT_BINARY_DIR}/single/skybark_${backend}.hpp")
        add_custom_command(OUTPUT "${single}"
            COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/cmake/single_header.py" ${backend} "${single}"
            DEPENDS "${PROJECT_SOURCE_DIR}/cmake/single_header.py" ${headers} VERBATIM)
        list(APPEND singles "${single}")
    endforeach()
    add_custom_target(single_headers DEPENDS ${singles})
    # cmake --install BUILD --component single_headers
    install(FILES ${singles} DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT single_headers
            EXCLUDE_FROM_ALL OPTIONAL)
endif()

# ---- cpack -G DEB: libskybark-dev, the headers alone ---------------------------------------------

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME libskybark-dev)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "GPU algorithms for natural scenes (C++20 headers)")
set(CPACK_PACKAGE_DESCRIPTION "Swaying trees, lit clouds and gathered light, as templates over a backend:
threads, OpenGL 4.5 or Vulkan 1.3. They work on the caller's device, throw
nothing and print nothing.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libglm-dev, libexpected-dev")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libvulkan-dev, libgtest-dev")
set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
if(NOT CPACK_DEBIAN_PACKAGE_MAINTAINER)
    set(CPACK_DEBIAN_PACKAGE_MAINTAINER "Skybark authors <authors@skybark.invalid>")
endif()

# What Debian wants beside the files themselves; `cmake --install` leaves it out.
find_program(SKYBARK_GZIP gzip)
mark_as_advanced(SKYBARK_GZIP)
if(SKYBARK_GZIP)
    set(debian "${PROJECT_SOURCE_DIR}/packaging/debian")
    set(notes "${PROJECT_BINARY_DIR}/debian")
    file(MAKE_DIRECTORY "${notes}")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${debian}/changelog")
    execute_process(COMMAND "${SKYBARK_GZIP}" -9nc "${debian}/changelog"
                    OUTPUT_FILE "${notes}/changelog.gz" COMMAND_ERROR_IS_FATAL ANY)
    install(FILES "${debian}/copyright" "${notes}/changelog.gz"
            DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/libskybark-dev" COMPONENT debian EXCLUDE_FROM_ALL)
    set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};skybark;ALL;/"
                                     "${PROJECT_BINARY_DIR};skybark;debian;/")
endif()

include(CPack)
