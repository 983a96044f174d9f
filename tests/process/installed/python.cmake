# The installed package for Python, with the installed worlds, and a controller in Python under the installed programs.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${FOLDER})
file(COPY ${EXAMPLES}/python DESTINATION ${FOLDER})
set(python ${CMAKE_COMMAND} -E env PYTHONPATH=${PREFIX}/lib/python3/dist-packages PYTHONDONTWRITEBYTECODE=1 ${PYTHON})

include(${CMAKE_CURRENT_LIST_DIR}/run_in.cmake)

run_in(${FOLDER}/python ${python} -c "
import troupe, troupe.rl, troupe.testing
assert troupe._troupe.__version__.startswith(troupe.__version__), troupe._troupe.__version__
assert str(troupe.rl.tasks.worlds_folder()) == '${PREFIX}/share/troupe/worlds'
env = troupe.rl.ParallelEnv(troupe.rl.Navigation())
env.reset(seed=1)
troupe.testing.check('${PREFIX}/share/troupe/worlds/scenarios/swarm.json', 'all_alive', ticks=5)
print('troupe', troupe.__version__)")
run_in(${FOLDER}/python ${python} drive.py ${PREFIX}/share/troupe/worlds/scenarios/swarm.json drive.png)
if(NOT text MATCHES "100 robots are [1-9]")
  message(FATAL_ERROR "drive.py printed\n${text}")
endif()

file(WRITE ${FOLDER}/python/run.json "{\"world\": \"${PREFIX}/share/troupe/worlds/office.world\", \"robots\": [
  {\"name\": \"anna\", \"model\": \"scout\", \"pose\": [-8, 0, 0], \"controller\": \"./patrol.py:Patrol\"}]}")
foreach(how --in-process --robots-per-process=1)
  run_in(${FOLDER}/python ${PREFIX}/bin/troupe run run.json ${how} --headless --speed max --ticks 50 --poses ${how}.csv)
  file(STRINGS ${FOLDER}/python/${how}.csv last REGEX "^50,anna,")
  if(NOT last OR last MATCHES "^50,anna,-8,0,")
    message(FATAL_ERROR "with a controller in Python the robot ended at '${last}'\n${text}")
  endif()
endforeach()
