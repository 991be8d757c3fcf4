# SPDX-License-Identifier: GPL-3.0-or-later
# `cpack` makes two packages: excursion (program, presets, manual; plugin and app where they are built) and
# libexcursion-dev.
set(EXCURSION_MAINTAINER "The Excursion authors <excursion@localhost>" CACHE STRING
    "Who made the Debian packages, with a mail address")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME excursion)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "finds out what a loudspeaker model is missing, and linearizes it")
set(CPACK_PACKAGE_CONTACT ${EXCURSION_MAINTAINER})
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME excursion)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION sound)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "gnuplot-nox | gnuplot")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Excursion reads a measurement of a loudspeaker, fits a physical model, names
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
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "excursion (= ${PROJECT_VERSION}-1), pkg-config, libeigen3-dev (>= 3.4), nlohmann-json3-dev (>= 3.11),\
 libceres-dev (>= 2.1), libfftw3-dev, libsndfile1-dev, libmatio-dev, libsoxr-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "Headers, static libraries and CMake files of Excursion: find_package(Excursion)
and Excursion::engine.")

# What Debian asks of every package: a copyright file, and a changelog of the package beside that of the program.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)   # SOURCE_DATE_EPOCH where it is set
file(CONFIGURE OUTPUT changelog.Debian CONTENT
"excursion (${PROJECT_VERSION}-1) unstable; urgency=medium

  * See changelog.gz.

 -- ${EXCURSION_MAINTAINER}  ${date}
")
if(GZIP)
    add_custom_command(OUTPUT changelog.gz changelog.Debian.gz
        COMMAND ${GZIP} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md > changelog.gz
        COMMAND ${GZIP} -9nc changelog.Debian > changelog.Debian.gz
        DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${CMAKE_CURRENT_BINARY_DIR}/changelog.Debian VERBATIM)
    add_custom_target(changelogs ALL DEPENDS ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz
        ${CMAKE_CURRENT_BINARY_DIR}/changelog.Debian.gz)
endif()
foreach(component program development)
    string(TOUPPER ${component} upper)
    set(documents share/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
    install(FILES copyright DESTINATION ${documents} COMPONENT ${component})
    if(GZIP)
        install(FILES ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz ${CMAKE_CURRENT_BINARY_DIR}/changelog.Debian.gz
            DESTINATION ${documents} COMPONENT ${component})
    endif()
endforeach()
include(CPack)
