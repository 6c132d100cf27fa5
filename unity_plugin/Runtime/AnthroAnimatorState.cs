using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// What an `Animator` is doing: the states of its layers and its parameters. Another avatar makes it start anew, and
    /// this lets it go on where it was.
    /// </summary>
    internal struct AnthroAnimatorState
    {
        int[] states;
        float[] times;
        AnimatorControllerParameter[] parameters;
        float[] values;

        /// <summary>Of an animator; of one that is not running, nothing.</summary>
        public static AnthroAnimatorState Of(Animator animator)
        {
            var state = new AnthroAnimatorState();
            if (!animator.isActiveAndEnabled || animator.runtimeAnimatorController == null || animator.avatar == null)
            {
                return state;
            }
            state.states = new int[animator.layerCount];
            state.times = new float[animator.layerCount];
            for (var layer = 0; layer < state.states.Length; layer++)
            {
                var info = animator.GetCurrentAnimatorStateInfo(layer);
                state.states[layer] = info.fullPathHash;
                state.times[layer] = info.normalizedTime;
            }
            state.parameters = animator.parameters;
            state.values = new float[state.parameters.Length];
            for (var i = 0; i < state.values.Length; i++)
            {
                var parameter = state.parameters[i];
                state.values[i] = parameter.type == AnimatorControllerParameterType.Float
                    ? animator.GetFloat(parameter.nameHash)
                    : parameter.type == AnimatorControllerParameterType.Int
                        ? animator.GetInteger(parameter.nameHash) : animator.GetBool(parameter.nameHash) ? 1f : 0f;
            }
            return state;
        }

        /// <summary>Lets an animator go on from here. A trigger that nothing used yet is lost.</summary>
        public void To(Animator animator)
        {
            if (states == null)
            {
                return;
            }
            for (var i = 0; i < values.Length; i++)
            {
                var name = parameters[i].nameHash;
                switch (parameters[i].type)
                {
                    case AnimatorControllerParameterType.Float:
                        animator.SetFloat(name, values[i]);
                        break;
                    case AnimatorControllerParameterType.Int:
                        animator.SetInteger(name, (int)values[i]);
                        break;
                    case AnimatorControllerParameterType.Bool:
                        animator.SetBool(name, values[i] != 0f);
                        break;
                }
            }
            for (var layer = 0; layer < states.Length; layer++)
            {
                animator.Play(states[layer], layer, times[layer]);
            }
        }
    }
}
