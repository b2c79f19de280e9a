!> The single list of keywords: specification and handler of each.
module keyword_catalogue
  use keywords_assembly, only: describe_assembly, describe_end_assembly, describe_end_instance, &
                               describe_end_part, describe_instance, describe_part
  use keyword_handler, only: keyword_list, pass_definitions, pass_elements, pass_nodes, pass_rest
  use keywords_amplitude, only: describe_amplitude, read_amplitude
  use keywords_base_motion, only: describe_base_motion, read_base_motion
  use keywords_boundary, only: describe_boundary, read_boundary
  use keywords_contact_law, only: describe_behavior, describe_friction, describe_interaction, &
                                  read_behavior, read_friction, read_interaction
  use keywords_contact_pair, only: describe_clearance, describe_contact_pair, read_clearance, &
                                   read_contact_pair
  use keywords_controls, only: describe_controls, describe_step_damping, read_controls, &
                               read_step_damping
  use keywords_elements, only: describe_element, read_elements
  use keywords_expansion, only: describe_expansion, read_expansion
  use keywords_equation, only: describe_equation, describe_mpc, read_equation, read_mpc
  use keywords_initial, only: describe_initial_conditions, read_initial_conditions
  use keywords_interface, only: describe_interface, read_interface
  use keywords_joint, only: describe_joint, describe_joint_law, read_joint, read_joint_law
  use keywords_other, only: add_ignored_keywords
  use keywords_loads, only: describe_cload, describe_dload, describe_dsload, read_cload, &
                            read_dload, read_dsload
  use keywords_material, only: describe_density, describe_material, describe_material_damping, &
                               read_density, read_material, read_material_damping
  use keywords_material_test, only: describe_material_test, read_material_test
  use keywords_nodes, only: describe_heading, describe_include, describe_node, read_heading, &
                            read_nodes
  use keywords_output, only: describe_el_file, describe_element_output, describe_envelope, &
                             describe_node_file, describe_node_output, describe_output, &
                             describe_preprint, read_envelope, read_files, read_fields, read_output
  use keywords_print, only: describe_el_print, describe_joint_print, describe_node_print, &
                            read_el_print, read_joint_print, read_node_print
  use keywords_refused, only: add_refused_keywords
  use keywords_reservoir, only: describe_reservoir, read_reservoir
  use keywords_section, only: describe_solid_section, read_solid_section
  use keywords_sets, only: describe_elset, describe_nset, describe_surface, read_elset, &
                           read_nset, read_surface
  use keywords_restart, only: describe_restart, read_restart
  use keywords_stages, only: describe_grout, describe_model_change, read_grout, read_model_change
  use keywords_step, only: describe_dynamic, describe_end_step, describe_frequency, &
                           describe_static, describe_step, read_dynamic, read_end_step, &
                           read_frequency, read_static, read_step
  use keywords_temperature, only: describe_temperature, read_temperature
  use keywords_tie, only: describe_tie, read_tie
  use material_catalogue, only: add_material_laws
  implicit none
  private
  public :: list_keywords

  integer, parameter :: most_keywords = 200

contains

  !> Makes the list, in the order of the reference.
  subroutine list_keywords(list)
    type(keyword_list), intent(out) :: list
    allocate (list%specs(most_keywords), list%entries(most_keywords))
    call add_model_keywords(list)
    call add_step_keywords(list)
    call add_output_keywords(list)
    call add_refused_keywords(list)
    call add_ignored_keywords(list)
    call list%trim()
  end subroutine list_keywords

  subroutine add_model_keywords(list)
    type(keyword_list), intent(inout) :: list
    call list%add(describe_heading, read_heading, pass_rest)
    call list%add(describe_include)
    call list%add(describe_node, read_nodes, pass_nodes)
    call list%add(describe_element, read_elements, pass_elements)
    call list%add(describe_nset, read_nset, pass_rest)
    call list%add(describe_elset, read_elset, pass_rest)
    call list%add(describe_surface, read_surface, pass_rest)
    call list%add(describe_part)
    call list%add(describe_end_part)
    call list%add(describe_assembly)
    call list%add(describe_instance)
    call list%add(describe_end_instance)
    call list%add(describe_end_assembly)
    call list%add(describe_material, read_material, pass_definitions)
    call list%add(describe_density, read_density, pass_definitions)
    call list%add(describe_material_damping, read_material_damping, pass_definitions)
    call list%add(describe_expansion, read_expansion, pass_definitions)
    call add_material_laws(list)
    call list%add(describe_material_test, read_material_test, pass_rest)
    call list%add(describe_solid_section, read_solid_section, pass_rest)
    call list%add(describe_joint_law, read_joint_law, pass_definitions)
    call list%add(describe_joint, read_joint, pass_rest)
    call list%add(describe_tie, read_tie, pass_rest)
    call list%add(describe_equation, read_equation, pass_rest)
    call list%add(describe_mpc, read_mpc, pass_rest)
    call list%add(describe_interface, read_interface, pass_rest)
    call list%add(describe_interaction, read_interaction, pass_definitions)
    call list%add(describe_behavior, read_behavior, pass_definitions)
    call list%add(describe_friction, read_friction, pass_definitions)
    call list%add(describe_contact_pair, read_contact_pair, pass_rest)
    call list%add(describe_clearance, read_clearance, pass_rest)
    call list%add(describe_amplitude, read_amplitude, pass_definitions)
    call list%add(describe_initial_conditions, read_initial_conditions, pass_rest)
  end subroutine add_model_keywords

  subroutine add_step_keywords(list)
    type(keyword_list), intent(inout) :: list
    call list%add(describe_step, read_step, pass_rest)
    call list%add(describe_end_step, read_end_step, pass_rest)
    call list%add(describe_static, read_static, pass_rest)
    call list%add(describe_dynamic, read_dynamic, pass_rest)
    call list%add(describe_frequency, read_frequency, pass_rest)
    call list%add(describe_controls, read_controls, pass_rest)
    call list%add(describe_step_damping, read_step_damping, pass_rest)
    call list%add(describe_boundary, read_boundary, pass_rest)
    call list%add(describe_cload, read_cload, pass_rest)
    call list%add(describe_dload, read_dload, pass_rest)
    call list%add(describe_dsload, read_dsload, pass_rest)
    call list%add(describe_reservoir, read_reservoir, pass_rest)
    call list%add(describe_base_motion, read_base_motion, pass_rest)
    call list%add(describe_temperature, read_temperature, pass_rest)
    call list%add(describe_model_change, read_model_change, pass_rest)
    call list%add(describe_grout, read_grout, pass_rest)
  end subroutine add_step_keywords

  subroutine add_output_keywords(list)
    type(keyword_list), intent(inout) :: list
    call list%add(describe_node_print, read_node_print, pass_rest)
    call list%add(describe_el_print, read_el_print, pass_rest)
    call list%add(describe_joint_print, read_joint_print, pass_rest)
    call list%add(describe_node_file, read_files, pass_rest)
    call list%add(describe_el_file, read_files, pass_rest)
    call list%add(describe_output, read_output, pass_rest)
    call list%add(describe_node_output, read_fields, pass_rest)
    call list%add(describe_element_output, read_fields, pass_rest)
    call list%add(describe_envelope, read_envelope, pass_rest)
    call list%add(describe_restart, read_restart, pass_rest)
    call list%add(describe_preprint, read_output, pass_rest)
  end subroutine add_output_keywords
end module keyword_catalogue
