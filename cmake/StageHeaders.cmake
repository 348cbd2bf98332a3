# At installation: the public `headers` of `source_dir` in `staged`, their includes of each other with the prefix cgcontact/.
file(REMOVE_RECURSE ${staged})
foreach(header ${headers})
  file(READ ${source_dir}/${header} text)
  string(REGEX REPLACE "(#include \")(core|kernels|recovery|contact)/" "\\1cgcontact/\\2/" text "${text}")
  file(WRITE ${staged}/${header} "${text}")
endforeach()
