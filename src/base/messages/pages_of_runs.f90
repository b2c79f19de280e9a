!> Pages on messages: what an analysis meets while it runs.
module pages_of_runs
  use message_pages, only: page_list
  implicit none
  private
  public :: add_pages_of_runs, add_page_of_umat

contains

  !> Adds all pages of this module, in the order in which their signs are looked for.
  subroutine add_pages_of_runs(list)
    type(page_list), intent(inout) :: list
    call pages_from_ranks(list)
    call pages_from_usage(list)
    call pages_from_no_memory(list)
    call pages_from_energy(list)
  end subroutine add_pages_of_runs

  subroutine pages_from_ranks(list)
    type(page_list), intent(inout) :: list
    call list%add('one-process', &
                  'in one process only|is built with PETSc|AUTO, DIRECT, BLR or', &
                  'Several processes under mpiexec do not work on this yet, or the program is '// &
                  'the plain one, which has no solvers for several processes.', &
                  'Start the deck without mpiexec and --solver; docs/large_models.md says what '// &
                  'several processes work on.', &
                  'mpiexec -n 2 keyway reduced.inp', &
                  'keyway -j 2 reduced.inp')
    call list%add('slow-solver', &
                  'conjugate gradients', &
                  'The iterative solver of several processes does not converge: a part of the '// &
                  'model is free to move, or stiffnesses differ too much.', &
                  'Add supports; or take the factor with --solver DIRECT.', &
                  'mpiexec -n 4 keyway --solver ITERATIVE dam.inp', &
                  'mpiexec -n 4 keyway --solver DIRECT dam.inp')
  end subroutine pages_from_ranks

  subroutine pages_from_usage(list)
    type(page_list), intent(inout) :: list
    call list%add('usage', &
                  'needs a value|no deck is named|unknown option|one deck at a time|goes with '// &
                  'an analysis|go with --umat|a number of threads|iterations of an increment '// &
                  'that is not saved', &
                  'The command line is not understood.', &
                  'keyway --help lists the options. The deck comes last.', &
                  'keyway -o', &
                  'keyway -o results dam.inp')
    call list%add('stopped', &
                  'stopped by', &
                  'A signal asked the program to end: Ctrl-C, a time limit, the end of a job '// &
                  'on a cluster. The increments up to there are kept.', &
                  'With *RESTART, WRITE in the deck, keyway --continue goes on from the last '// &
                  'checkpoint.', &
                  'kill PID', &
                  'keyway --continue -o results dam.inp')
    call list%add('continue', &
                  '--continue:|cannot continue|from before the checkpoint', &
                  'The run cannot go on from the checkpoint: there is none, its deck was '// &
                  'another one, or files of the results are missing, changed or damaged. VTK '// &
                  'files that are missing are a warning.', &
                  'Only later steps may be changed between the two runs; *RESTART, WRITE makes '// &
                  'checkpoints. Put files back that were moved or removed. Without --continue '// &
                  'the analysis begins anew.', &
                  'keyway --continue with a changed mesh', &
                  'keyway -o results dam.inp')
    call list%add('folder-in-use', &
                  'runs this job|cannot take the lock|would write over|write in the folder', &
                  'Another run writes into the same folder, or the results would replace a '// &
                  'file that the run reads, or the folder may not be written.', &
                  'Wait for the other run, or give another folder with -o.', &
                  'two runs of dam.inp with -o results', &
                  '-o first and -o second')
    call list%add('disk-full', &
                  'cannot write|disk full', &
                  'A file of the results could not be written. What was written before is kept.', &
                  'Make room, or ask for fewer fields: FREQUENCY in *NODE FILE and *EL FILE. '// &
                  'keyway --check forecasts the size of all files.', &
                  '*EL FILE in every increment', &
                  '*EL FILE, FREQUENCY=20')
  end subroutine pages_from_usage

  subroutine pages_from_no_memory(list)
    type(page_list), intent(inout) :: list
    call list%add('large-factor', &
                  'more than 2^31 entries', &
                  'One process counts the entries of the factor with 32 bits. The model has '// &
                  'more of them.', &
                  'Several processes divide the factor (docs/large_models.md). A coarser mesh '// &
                  'has a smaller one; keyway --check forecasts its size.', &
                  'keyway -j 16 dam.inp', &
                  'mpiexec -n 8 keyway dam.inp')
    call list%add('no-memory', &
                  'no memory|out of memory|memory', &
                  'The system does not give the memory that the analysis needs.', &
                  'keyway --check forecasts the memory of a run. A coarser mesh, fewer points '// &
                  'of joints and one thread take less.', &
                  'keyway -j 16 dam.inp', &
                  'keyway -j 1 dam.inp')
    call add_page_of_umat(list)
    call list%add('increments-used-up', &
                  'has not ended after', &
                  'Every increment has converged, but the step has had as many increments as '// &
                  'INC of *STEP allows before its duration was over. The results up to there '// &
                  'are kept and can be read.', &
                  'Raise INC: the duration over the size of an increment, and more where '// &
                  'increments are cut. Without INC a step may have 100000. Larger increments '// &
                  'need fewer.', &
                  '*STEP, INC=2; *STATIC; 0.1, 1.', &
                  '*STEP, INC=100; *STATIC; 0.1, 1.')
    call list%add('no-equilibrium', &
                  'no equilibrium|penetration of a contact|does not converge|did not '// &
                  'converge|no initial acceleration|time increment|smallest increment', &
                  'The iteration of an increment found no equilibrium, also after the '// &
                  'increment was cut. The results up to there are kept and can be read.', &
                  'Look at the place that the message names and at the last fields. Often a '// &
                  'block has become free, a load is beyond what the model bears, or the unit '// &
                  'of a stiffness is wrong. Smaller increments, and more of them (*STEP, INC), '// &
                  'help where cracks run.', &
                  '*STATIC; 1., 1.', &
                  '*STATIC; 0.05, 1., 1e-5')
    call list%add('free-block', &
                  'the block with|blocks with|cannot stand|is singular|positive definite|no '// &
                  'resistance', &
                  'The stiffness is singular, or a block has become free: joints have opened '// &
                  'or slide on all its sides.', &
                  'The message names an element of the block and its motion. Compare the loads '// &
                  'with what friction and cohesion of the joints bear; look for a missing '// &
                  'support or tie.', &
                  'a block on an inclined joint, FRICTION=0', &
                  'FRICTION above the slope')
    call list%add('large-slip', &
                  'has slipped', &
                  'A point of a joint between different meshes has slid further than one '// &
                  'facet. Sliding is small there: the faces that were opposite at the start '// &
                  'stay partners.', &
                  'The answer up to the time named is right. Matching meshes, or larger '// &
                  'facets, bear more; slips of metres are outside of what the program can do.')
  end subroutine pages_from_no_memory

  !> The page of a user material that fails, also while a deck is read.
  subroutine add_page_of_umat(list)
    type(page_list), intent(inout) :: list
    call list%add('umat-failed', &
                  'UMAT|DDSDDE|UEXTERNALDB|DROT|the law of a user|call without strain', &
                  'The user material could not be compiled or loaded, or stopped the analysis.', &
                  'The lines below the message are those of the compiler, or of the UMAT. '// &
                  '--umat-check compares DDSDDE with differences of STRESS; --material leads '// &
                  'one point along a path.', &
                  'keyway --umat law.f90 dam.inp', &
                  'keyway --umat law.f90 --umat-check dam.inp')
  end subroutine add_page_of_umat

  subroutine pages_from_energy(list)
    type(page_list), intent(inout) :: list
    call list%add('energy', &
                  'of the energy balance|created more than a tenth|has added more|dissipated '// &
                  'much', &
                  'The balance of energy shows that the answer is not to be trusted: the law '// &
                  'or the time stepping has created energy, or a crack ran through in one '// &
                  'increment.', &
                  'Take smaller increments. For concrete under earthquakes, docs/theory.md '// &
                  '11.9 says what a closing crack does and what RECOVERY=ENERGY changes.', &
                  '0.02 s increments', &
                  '0.005 s increments, or RECOVERY=ENERGY')
    call list%add('fixed-recovery', &
                  'prevented equilibrium', &
                  'With RECOVERY=SIGN the stiffness of cracked concrete jumps where a crack '// &
                  'closes or opens. An increment had no equilibrium on either side of the '// &
                  'jump. The program kept the recovery of the start of the increment in it.', &
                  'Compare with a run with RECOVERY=ENERGY, whose stress does not jump. '// &
                  'docs/theory.md 11.9 compares the kinds of RECOVERY.', &
                  '*CONCRETE DAMAGED PLASTICITY, RECOVERY=SIGN', &
                  '*CONCRETE DAMAGED PLASTICITY, RECOVERY=ENERGY')
    call list%add('accuracy', &
                  'does not reach the ACCURACY|estimated error', &
                  'The estimate of the error is above the accuracy that the deck asks for.', &
                  'Run the case with smaller increments, or without REDUCED.')
    call list%add('modes', &
                  'no mode up to|modes|frequencies|eigenvalue', &
                  'The natural modes that were asked for could not be computed: fewer exist, '// &
                  'or the iteration did not end.', &
                  'Ask for fewer modes. A mode needs mass (*DENSITY) and supports.', &
                  '*FREQUENCY; 500', &
                  '*FREQUENCY; 20')
  end subroutine pages_from_energy
end module pages_of_runs
