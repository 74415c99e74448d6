# cmake -DREADME=… -DPROGRAM=… -DLANGUAGE=… -P readme_test.cmake: the README shows the program that is compiled.
file(READ "${README}" readme)
file(READ "${PROGRAM}" program)
string(FIND "${readme}" "```${LANGUAGE}\n${program}```" place)
if(place EQUAL -1)
  message(FATAL_ERROR "README.md does not show ${PROGRAM} as it is")
endif()
