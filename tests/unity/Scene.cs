using System;
using System.Collections.Generic;
using System.Reflection;
using UnityEngine;

namespace Anthronet.Tests
{
    /// Shared set-up of tests.
    static class Scene
    {
        const BindingFlags Hidden = BindingFlags.Instance | BindingFlags.Static | BindingFlags.NonPublic;

        internal static AnthroRequest Request(double height = 1.8)
        {
            return new AnthroRequest { Sex = AnthroSex.Male, Seed = 11 }.Set("height", height);
        }

        internal static AnthroCharacter Character(int finest = 1, int coarsest = 1)
        {
            return AnthroFactory.Create(Request(), new AnthroSettings { finestLod = finest, coarsestLod = coarsest });
        }

        internal static int Joint(AnthroCharacter character, string name)
        {
            var place = character.Rig.IndexOf(name);
            Expect.That(place >= 0, "no joint " + name);
            return place;
        }

        internal static Vector3 WorldPosition(Transform transform)
        {
            var m = transform.localToWorldMatrix;
            return new Vector3(m.m03, m.m13, m.m23);
        }

        /// Switches to edit mode until it is disposed.
        internal static IDisposable EditMode()
        {
            Application.Playing = false;
            return new Playing();
        }

        sealed class Playing : IDisposable
        {
            public void Dispose() { Application.Playing = true; }
        }

        /// Simulates a domain reload of a component: only serialised fields survive.
        internal static void Reload(MonoBehaviour part)
        {
            foreach (var field in Fields(part.GetType()))
            {
                if (!field.IsStatic && !field.IsPublic && !Attribute.IsDefined(field, typeof(SerializeField)))
                {
                    field.SetValue(part, field.FieldType.IsValueType ? Activator.CreateInstance(field.FieldType) : null);
                }
            }
            part.Enabled = false;
            MonoBehaviour.Send(part, "OnEnable");
            part.Enabled = true;
        }

        /// All fields of a component, including private ones of base classes.
        static IEnumerable<FieldInfo> Fields(Type type)
        {
            for (; type != typeof(MonoBehaviour); type = type.BaseType)
            {
                foreach (var field in type.GetFields(Hidden | BindingFlags.DeclaredOnly))
                {
                    yield return field;
                }
            }
        }

        /// A private field of an object.
        internal static object Field(object home, string name)
        {
            return home.GetType().GetField(name, Hidden).GetValue(home);
        }

        internal static object Static(Type type, string name)
        {
            return type.GetField(name, Hidden).GetValue(null);
        }

        internal static void Destroy(AnthroCharacter character)
        {
            if (Application.isPlaying)
            {
                UnityEngine.Object.Destroy(character.gameObject);
            }
            else
            {
                UnityEngine.Object.DestroyImmediate(character.gameObject);
            }
        }
    }
}
