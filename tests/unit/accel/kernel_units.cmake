# A processor without AVX must never meet an instruction of it by accident.
# Units are those of ARCHIVE whose names begin with UNITS; there are COUNT of them.
#  1. The units of the kernels define no weak symbol: the linker could take it for the same
#     function of another unit.
#  2. No other unit of the archive names a register that AVX brought.
execute_process(COMMAND ${NM} --defined-only ${ARCHIVE} OUTPUT_VARIABLE symbols
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${OBJDUMP} -d --no-show-raw-insn ${ARCHIVE} OUTPUT_VARIABLE code
                COMMAND_ERROR_IS_FATAL ANY)

set(units 0)
string(REGEX REPLACE "\n([^ \n]+\\.o):\n" ";\\1\n" members "${symbols}")
foreach(member ${members})
  if(member MATCHES "^${UNITS}")
    math(EXPR units "${units} + 1")
    if(member MATCHES "[0-9a-f]+ ([WVu]) ([^\n]+)")
      message(SEND_ERROR "a kernel's unit defines ${CMAKE_MATCH_2}, which another may share")
    endif()
  endif()
endforeach()
if(NOT units EQUAL COUNT)
  message(SEND_ERROR "expected ${COUNT} units of kernels in ${ARCHIVE}, found ${units}")
endif()

string(REPLACE ";" " " code "${code}")
string(REGEX REPLACE "\n([^ \n]+\\.o): +file format" ";\\1 " members "${code}")
set(wide 0)
foreach(member ${members})
  if(member MATCHES "%[yz]mm|%k[1-7]")
    math(EXPR wide "${wide} + 1")
    if(NOT member MATCHES "^${UNITS}")
      string(REGEX MATCH "^[^ ]+" unit "${member}")
      message(SEND_ERROR "${unit} holds instructions of AVX")
    endif()
  endif()
endforeach()
if(NOT wide EQUAL COUNT)
  message(SEND_ERROR "the kernels' units should hold instructions of AVX; ${wide} do")
endif()
