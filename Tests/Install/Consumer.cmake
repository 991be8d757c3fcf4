# SPDX-License-Identifier: GPL-3.0-or-later
# An installed Excursion, moved to another place, is found by a project that knows nothing of this one, and used by it.
#     cmake -DBUILD=... -DSOURCE=... -DVERSION=... -DGENERATOR=... -DCOMPILER=... -P Consumer.cmake
cmake_minimum_required(VERSION 3.25)
set(scratch ${BUILD}/Tests/Install/scratch)
file(REMOVE_RECURSE ${scratch})
file(MAKE_DIRECTORY ${scratch})

# run(CODE COMMAND...): the command must end with that exit code; what it said is in `said`.
function(run expected)
    execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${scratch} RESULT_VARIABLE code OUTPUT_VARIABLE out
        ERROR_VARIABLE err)
    if(expected STREQUAL "not 0" AND NOT code EQUAL 0)
        set(code "not 0")
    endif()
    if(NOT code STREQUAL expected)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "${command}\nended with ${code}, expected ${expected}:\n${out}${err}")
    endif()
    set(said "${out}${err}" PARENT_SCOPE)
endfunction()

run(0 ${CMAKE_COMMAND} --install ${BUILD} --prefix ${scratch}/first)
file(RENAME ${scratch}/first "${scratch}/moved there")

# No file of CMake names the place where it was built or installed.
file(GLOB_RECURSE files "${scratch}/moved there/*.cmake")
foreach(file ${files})
    file(STRINGS "${file}" text REGEX "${SOURCE}|${BUILD}|${scratch}/first")
    if(text)
        message(FATAL_ERROR "${file} names a place of this computer:\n${text}")
    endif()
endforeach()

file(COPY ${SOURCE}/examples/PredistortBuffer.cpp DESTINATION ${scratch}/consumer)
file(WRITE ${scratch}/consumer/CMakeLists.txt "
cmake_minimum_required(VERSION 3.25)
project(Consumer LANGUAGES CXX)
find_package(Excursion \${WANTED} REQUIRED)
if(NOT EXISTS \"\${Excursion_PRESETS}/drivers/woofer.json\")
    message(FATAL_ERROR \"no presets at \${Excursion_PRESETS}\")
endif()
add_executable(consumer PredistortBuffer.cpp)
target_link_libraries(consumer PRIVATE Excursion::engine)
")
set(configure ${CMAKE_COMMAND} -S consumer -B consumer-build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
    "-DCMAKE_PREFIX_PATH=${scratch}/moved there")
run(0 ${configure} -DWANTED=${VERSION})
run(0 ${CMAKE_COMMAND} --build consumer-build)
run(0 ${scratch}/consumer-build/consumer "${scratch}/moved there/share/excursion/presets/drivers/woofer.json")
message(STATUS "${said}")

# Another version is not taken for this one.
run("not 0" ${configure} -DWANTED=99.0)
if(NOT said MATCHES "99.0")
    message(FATAL_ERROR "A version that is not installed was refused for another reason:\n${said}")
endif()

# The program works from where it is.
if(EXISTS "${scratch}/moved there/bin/excursion")
    run(0 "${scratch}/moved there/bin/excursion" --version)
    if(NOT said MATCHES "^${VERSION}")
        message(FATAL_ERROR "excursion --version said ${said}")
    endif()
endif()
file(REMOVE_RECURSE ${scratch})
