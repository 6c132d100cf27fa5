using System;
using UnityEngine;

namespace Anthronet.Samples
{
    /// <summary>Plays the built-in clips and a motion file on a character, with a time slider.</summary>
    public sealed class ClipPlayer : MonoBehaviour
    {
        [Tooltip("A .bvh, .fbx, .glb, .gltf, .vrma, .npz or .usd file; may be empty.")]
        public string file = "";

        AnthroAnimator animator;
        AnthroClip fromFile;
        string error = "";

        void Start()
        {
            var character = AnthroFactory.Create(
                new AnthroRequest { Sex = AnthroSex.Male }, new AnthroSettings { finestLod = 0, parent = transform });
            animator = character.gameObject.AddComponent<AnthroAnimator>();
            animator.Play("idle");
            if (file.Length > 0)
            {
                Open(character);
            }
        }

        void Open(AnthroCharacter character)
        {
            try
            {
                fromFile = AnthroClip.Open(file, character.Body);
                animator.Play(fromFile);
            }
            catch (AnthroException refused)
            {
                error = refused.Message;
            }
        }

        void OnGUI()
        {
            GUILayout.BeginArea(new Rect(10, 10, 300, Screen.height - 20));
            foreach (var name in AnthroClip.BuiltinNames())
            {
                if (GUILayout.Button(name))
                {
                    animator.Play(name);
                }
            }
            if (fromFile != null && GUILayout.Button(fromFile.Name))
            {
                animator.Play(fromFile);
            }
            if (GUILayout.Button(animator.Speed == 0f ? "Play" : "Pause"))
            {
                animator.Speed = animator.Speed == 0f ? 1f : 0f;
            }
            var duration = (float)animator.Clip.Duration;
            // Wrap the time into the clip; remainders of negative times would be negative.
            var time = (float)(animator.Time - duration * Math.Floor(animator.Time / duration));
            var moved = GUILayout.HorizontalSlider(time, 0f, duration);
            if (moved != time)
            {
                animator.Time = moved;
            }
            GUILayout.Label(animator.Clip.Name + ", " + duration.ToString("0.00") + " s " + error);
            GUILayout.EndArea();
        }

        void OnDestroy()
        {
            if (fromFile != null)
            {
                fromFile.Dispose();
            }
        }
    }
}
