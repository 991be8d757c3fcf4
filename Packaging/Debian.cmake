# SPDX-License-Identifier: GPL-3.0-or-later
# `cpack` makes two packages: excursion (program, presets, manual; plugin and app where they are built) and libexcursion-dev.
set(EXCURSION_MAINTAINER "The Excursion authors <excursion@localhost>" CACHE STRING "Who made the Debian packages, with a mail address")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME excursion)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT ${EXCURSION_MAINTAINER})
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME excursion)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION sound)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "gnuplot-nox | gnuplot")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "finds out what a loudspeaker model is missing
Excursion reads a measurement of a loudspeaker, fits a physical model, names
the physical effect that is missing, adds it and fits again until only the
noise of the measurement is left. With the model it linearizes the
loudspeaker.")
if(TARGET ExcursionPlugin_Standalone)
    # JUCE loads these when it opens a window, so dpkg-shlibdeps does not see them.
    set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libx11-6, libxcursor1, libxext6, libxinerama1, libxrandr2")
    set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "libjack-jackd2-0 | libjack-0.125")
endif()

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libexcursion-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "excursion (= ${PROJECT_VERSION}), pkg-config, libeigen3-dev (>= 3.4), nlohmann-json3-dev (>= 3.11),\
 libceres-dev (>= 2.1), libfftw3-dev, libsndfile1-dev, libmatio-dev, libsoxr-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "finds out what a loudspeaker model is missing (development files)
Headers, static libraries and CMake files of Excursion: find_package(Excursion)
and Excursion::engine.")

# What Debian asks of every package, when one is made: a copyright file and a changelog.
foreach(component program development)
    string(TOUPPER ${component} upper)
    set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
    install(FILES copyright DESTINATION share/doc/${package} COMPONENT ${component})
    if(GZIP)
        add_custom_command(OUTPUT ${package}/changelog.gz
            COMMAND ${CMAKE_COMMAND} -E make_directory ${package}
            COMMAND ${GZIP} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md > ${package}/changelog.gz
            DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md VERBATIM)
        add_custom_target(changelog_${component} ALL DEPENDS ${CMAKE_CURRENT_BINARY_DIR}/${package}/changelog.gz)
        install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${package}/changelog.gz DESTINATION share/doc/${package} COMPONENT ${component})
    endif()
endforeach()
include(CPack)
