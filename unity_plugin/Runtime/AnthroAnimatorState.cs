using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// The current states of an `Animator`'s layers and its parameters. Assigning another avatar resets an `Animator`;
    /// this restores what it was doing.
    /// </summary>
    internal struct AnthroAnimatorState
    {
        int[] states;
        float[] times;
        AnimatorControllerParameter[] parameters;
        float[] values;

        /// <summary>Captures the state of an animator; nothing if the animator is not running.</summary>
        public static AnthroAnimatorState Capture(Animator animator)
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

        /// <summary>Restores the captured state. Triggers that no transition has consumed yet are lost.</summary>
        public void Restore(Animator animator)
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
