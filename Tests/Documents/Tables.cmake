# SPDX-License-Identifier: GPL-3.0-or-later
# The tables of Docs/Architecture.md under "Where things live" name what is in the tree, every effect, and every
# chapter; those of Docs/Dissertation.md what is in the tree, every section, numbered equation and listing.
#     cmake -DSOURCE=... -DPROGRAM=... -P Tables.cmake
cmake_minimum_required(VERSION 3.25)
file(READ ${SOURCE}/Docs/Architecture.md text)
if(NOT text MATCHES "\n## Where things live\n(.*)\n## An effect is one file\n")
    message(FATAL_ERROR "Docs/Architecture.md has no \"## Where things live\" before \"## An effect is one file\".")
endif()
set(tables "${CMAKE_MATCH_1}")
set(faults "")

# What is named exists.
string(REGEX MATCHALL "`(Source|Tests)/[^`]*`" paths "${tables}")
list(LENGTH paths count)
if(count LESS 60)
    string(APPEND faults "\nonly ${count} paths were found in the tables")
endif()
foreach(path ${paths})
    string(REPLACE "`" "" path ${path})
    if(NOT EXISTS ${SOURCE}/${path})
        string(APPEND faults "\n${path} is named and does not exist")
    endif()
endforeach()

# Every effect that the program knows has a row, and every file of an effect is named.
execute_process(COMMAND ${PROGRAM} effects --json OUTPUT_VARIABLE known COMMAND_ERROR_IS_FATAL ANY)
string(JSON last LENGTH "${known}" effects)
math(EXPR last "${last} - 1")
foreach(k RANGE ${last})
    string(JSON id GET "${known}" effects ${k} id)
    if(NOT tables MATCHES "\n\\| `${id}` \\| `Source/Engine/Loudspeaker/Effects/[A-Za-z]*.cpp` \\| `Source/Bench/")
        string(APPEND faults "\nthe effect ${id} has no row with its file and its counterpart on the bench")
    endif()
endforeach()
file(GLOB files RELATIVE ${SOURCE} ${SOURCE}/Source/Engine/Loudspeaker/Effects/*.cpp)
foreach(file ${files})
    if(NOT tables MATCHES "`${file}`")
        string(APPEND faults "\n${file} is not named")
    endif()
endforeach()

# Every chapter and appendix of the dissertation, and every class of models that has a document of its own.
foreach(part 2.1 2.2 2.3 3.1 3.2 3.3 4.1 4.2 4.3 4.4 5.1 5.2 5.3 5.4 6.1 6.2 7.1 7.2 "appendix A" "appendix B"
    "appendix C" "appendix D")
    string(REPLACE "." "\\." pattern ${part})
    if(NOT tables MATCHES "\n\\| ([0-9.]+, )?${pattern}[ ,]")
        string(APPEND faults "\n${part} of the dissertation has no row")
    endif()
endforeach()
foreach(layer Linear Fractional Polynomial)
    file(GLOB_RECURSE files RELATIVE ${SOURCE} ${SOURCE}/Source/Engine/${layer}/*File.h)
    foreach(file ${files})
        if(NOT tables MATCHES "`${file}`")
            string(APPEND faults "\n${file} belongs to no class of models in the table")
        endif()
    endforeach()
endforeach()

if(faults)
    message(FATAL_ERROR "Docs/Architecture.md, \"Where things live\":${faults}")
endif()

file(READ ${SOURCE}/Docs/Dissertation.md text)
# Paths are from the root or from Source/Engine.
string(REGEX MATCHALL "`[A-Z][A-Za-z]*/[A-Za-z/.-]*`" paths "${text}")
list(LENGTH paths named)
if(named LESS 150)
    string(APPEND faults "\nonly ${named} paths were found")
endif()
foreach(path ${paths})
    string(REPLACE "`" "" path ${path})
    if(NOT EXISTS ${SOURCE}/${path} AND NOT EXISTS ${SOURCE}/Source/Engine/${path})
        string(APPEND faults "\n${path} is named and does not exist")
    endif()
endforeach()

# The first cells of all rows. No brackets and semicolons in them, as these mean something in lists.
string(REGEX REPLACE "[][;]" " " rows "${text}")
string(REGEX MATCHALL "\n\\| [^|]*" firsts "${rows}")
string(REPLACE ";" "" firsts "${firsts}")
foreach(section 1 2.1 2.2 2.3 3.1 3.2 3.3 4.1.1 4.1.2 4.1.3 4.1.4 4.2.1 4.2.2 4.2.3 4.3 4.3.1 4.3.2 4.4.1 4.4.2 4.5
    5.1.1 5.1.2 5.1.3
        5.1.4 5.2.1 5.2.2 5.3 5.4 5.5 5.6 6.1.1 6.1.2 6.1.3 6.1.4 6.2.1 6.2.2 6.2.3 6.2.4 6.2.5 6.2.6 7.1 7.2 7.3)
    string(REPLACE "." "\\." pattern ${section})
    if(NOT firsts MATCHES "\n\\| ([0-9.]+, )?${pattern}[ ,]")
        string(APPEND faults "\nsection ${section} has no row")
    endif()
endforeach()
foreach(listing BLA Excitation_signal multisine IOdelay mckelvey_algo1 mckelvey_algo2 SubSpace_CT_simple LM_algo cost
    jacobianPNLSSvsEF
        unflatten_theta PNLSSfilter CalculateP diffmonomials getmonomialpwrs monomials prunepz removepz shownewsys
        prunePZpairs
        StabilizeSS zpplot3D fo_pzmap)
    if(NOT firsts MATCHES "\n\\| `${listing}` ")
        string(APPEND faults "\nthe listing ${listing} has no row")
    endif()
endforeach()

# Equations, alone as (4.9) or as a range, (4.14) to (4.16).
string(REGEX MATCHALL "\\([2-7]\\.[0-9]+\\)( to \\([2-7]\\.[0-9]+\\))?" equations "${firsts}")
set(covered "")
foreach(equation ${equations})
    if(equation MATCHES "^\\(([2-7])\\.([0-9]+)\\)( to \\([2-7]\\.([0-9]+)\\))?$")
        set(chapter ${CMAKE_MATCH_1})
        set(from ${CMAKE_MATCH_2})
        set(to ${CMAKE_MATCH_2})
        if(CMAKE_MATCH_4)
            set(to ${CMAKE_MATCH_4})
        endif()
        foreach(number RANGE ${from} ${to})
            list(APPEND covered "${chapter}.${number}")
        endforeach()
    endif()
endforeach()
foreach(last 2.4 4.26 5.41 6.38 7.3)
    string(REGEX MATCH "^([0-9])\\.([0-9]+)$" unused ${last})
    set(chapter ${CMAKE_MATCH_1})
    foreach(number RANGE 1 ${CMAKE_MATCH_2})
        if(NOT "${chapter}.${number}" IN_LIST covered)
            string(APPEND faults "\nequation (${chapter}.${number}) has no row")
        endif()
    endforeach()
endforeach()
if(faults)
    message(FATAL_ERROR "Docs/Dissertation.md:${faults}")
endif()
message(STATUS "${count} paths, all effects, all chapters; "
    "${named} paths, all sections, equations and listings of the dissertation")
