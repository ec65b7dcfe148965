# Installs Palpate for the tutorials into a prefix of its own: PREFIX, from BUILD.
foreach(component core baselines scenes filters io stream devices run c c-dev python io-helper program)
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX} --config ${CONFIG}
                          --component palpate-${component}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()
